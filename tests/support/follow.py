"""Jobs seen through to their end over HTTP."""

from __future__ import annotations

from typing import Any

import httpx

from tests.support.service import until

GLB = {"Content-Type": "model/gltf-binary"}
FINAL = ("succeeded", "failed", "canceled")


def submit(http: httpx.Client, content: bytes, **options: Any) -> str:
    answer = http.post("/v1/unwrap", content=content, headers=GLB, params=options)
    assert answer.status_code == 202, answer.text
    return str(answer.json()["id"])


def look(http: httpx.Client, job_id: str) -> dict[str, Any]:
    answer = http.get(f"/v1/jobs/{job_id}")
    assert answer.status_code == 200, answer.text
    return dict(answer.json())


def ended(http: httpx.Client, job_id: str, at_most_s: float = 180.0) -> dict[str, Any]:
    """The job at its end."""

    def there() -> dict[str, Any] | None:
        job = look(http, job_id)
        return job if job["status"] in FINAL else None

    return dict(until(there, at_most_s, every_s=0.1))


def running(http: httpx.Client, job_id: str, *, past: float = 0.0) -> dict[str, Any]:
    """The job as soon as a worker has it, and its progress is past a mark."""

    def there() -> dict[str, Any] | None:
        job = look(http, job_id)
        assert job["status"] not in FINAL, f"ended before it could be seen running: {job}"
        return job if job["status"] == "running" and job["progress"] > past else None

    return dict(until(there, 120.0, every_s=0.03))
