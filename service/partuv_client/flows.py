"""What the client does, without doing it: generators that ask for requests and pauses.

`PartUV` and `AsyncPartUV` carry the steps out, each in its own way; the logic is here once.
"""

from __future__ import annotations

import json
import uuid
from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from partuv_contract.jobs import Job, JobStatus
from partuv_contract.options import UnwrapOptions
from partuv_contract.problem import Problem
from pydantic import ValidationError

from partuv_client.errors import (
    JobCanceledError,
    JobFailedError,
    ProblemError,
    ServiceUnreachableError,
)

_TRANSIENT = (0, 429, 502, 503, 504)
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 0.1, 1.0
_LONGEST_RETRY_S = 60.0

OnProgress = Callable[[Job], None]


@dataclass(frozen=True)
class Request:
    """A step: send this and bring the answer."""

    method: str
    path: str
    headers: Mapping[str, str] = field(default_factory=dict)
    query: Mapping[str, str | list[str]] = field(default_factory=dict)
    content: bytes | None = None


@dataclass(frozen=True)
class Pause:
    """A step: wait."""

    seconds: float


@dataclass(frozen=True)
class Answer:
    """What came back; status 0 if nothing did, with the reason as the body."""

    status: int
    headers: Mapping[str, str]
    body: bytes


@dataclass(frozen=True)
class Unwrapped:
    """A finished job and its GLB."""

    glb: bytes
    job: Job

    def save(self, path: str | Path) -> None:
        """Write the GLB."""
        Path(path).write_bytes(self.glb)


Step = Request | Pause
Steps = Generator[Step, Answer | None, Any]


@dataclass
class Unwrapping:
    """One unwrap under way; `job` is known as soon as the service accepted it."""

    source: str | Path | bytes
    options: Mapping[str, Any]
    on_progress: OnProgress | None = None
    webhook_url: str | None = None
    job: Job | None = None

    def steps(self) -> Steps:
        """Submit, follow, fetch: ends with `Unwrapped`."""
        self.job = yield from submit(self.source, self.options, webhook_url=self.webhook_url)
        self.job = yield from follow(self.job, self.on_progress)
        glb = yield from fetch(self.job, "result")
        return Unwrapped(glb, self.job)


def submit(
    source: str | Path | bytes,
    options: Mapping[str, Any],
    *,
    webhook_url: str | None = None,
    retention_s: int | None = None,
) -> Steps:
    """Upload; ends with the `Job`. Safe to repeat: the idempotency key is made once."""
    content = source if isinstance(source, bytes) else Path(source).read_bytes()
    query = _query(options)
    if webhook_url is not None:
        query["webhook_url"] = webhook_url
    if retention_s is not None:
        query["retention_s"] = str(retention_s)
    headers = {"Content-Type": "model/gltf-binary", "Idempotency-Key": uuid.uuid4().hex}
    answer = yield from _ask(Request("POST", "/v1/unwrap", headers, query, content))
    return _job(answer)


def look(job_id: str) -> Steps:
    """Ends with the `Job` as it is."""
    return _job((yield from _ask(Request("GET", f"/v1/jobs/{job_id}"))))


def follow(job: Job, on_progress: OnProgress | None = None) -> Steps:
    """Wait for the end; ends with the succeeded `Job`, raises if it did not succeed."""
    pause_s = _FIRST_PAUSE_S
    while True:
        if on_progress is not None:
            on_progress(job)
        if job.status.final:
            break
        yield Pause(pause_s)
        pause_s = min(pause_s * 1.5, _LONGEST_PAUSE_S)
        job = yield from look(job.id)
    if job.status is JobStatus.CANCELED:
        raise JobCanceledError(job)
    if job.error is not None:
        raise JobFailedError(job.error, job)
    return job


def cancel(job_id: str) -> Steps:
    """Ends with the `Job` after it was asked to stop."""
    return _job((yield from _ask(Request("POST", f"/v1/jobs/{job_id}/cancel"))))


def delete(job_id: str) -> Steps:
    """Stop and forget; ends with nothing."""
    yield from _ask(Request("DELETE", f"/v1/jobs/{job_id}"))


def fetch(job: Job, file: str) -> Steps:
    """Ends with the bytes of a file of a finished job: result, preview, atlas or parts."""
    path = getattr(job.links, file)
    if path is None:
        raise ValueError(f"{job.id} has no {file}")
    return (yield from _ask(Request("GET", path))).body


def _query(options: Mapping[str, Any]) -> dict[str, str | list[str]]:
    """Options as a query; raises `OptionError` where this side knows better already."""
    parsed = UnwrapOptions.parse(
        {name: value for name, value in options.items() if value is not None}
    )
    given = parsed.model_dump(mode="json", exclude_unset=True)
    return {name: _text(value) for name, value in given.items()}


def _text(value: Any) -> str | list[str]:
    if isinstance(value, list):
        return [str(one) for one in value]
    return value if isinstance(value, str) else json.dumps(value)


def patiently(steps: Steps, retries: int) -> Steps:
    """The same steps, with requests sent again that failed for a passing reason."""
    answer: Answer | None = None
    while True:
        try:
            step = steps.send(answer)
        except StopIteration as end:
            return end.value
        answer = yield step
        for attempt in range(retries):
            if answer is None or answer.status not in _TRANSIENT:
                break
            yield Pause(_retry_s(answer, attempt))
            answer = yield step


def _ask(request: Request) -> Generator[Step, Answer | None, Answer]:
    answer = yield request
    if answer is None or answer.status == 0:
        raise ServiceUnreachableError(answer.body.decode() if answer else "no answer")
    if answer.status >= 400:
        raise ProblemError(_problem(answer))
    return answer


def _retry_s(answer: Answer, attempt: int) -> float:
    hint = answer.headers.get("retry-after", "")
    if hint.isdigit():
        return min(float(hint), _LONGEST_RETRY_S)
    return min(0.25 * 2.0**attempt, 8.0)


def _job(answer: Answer) -> Job:
    try:
        return Job.model_validate_json(answer.body)
    except ValidationError as failure:
        raise ServiceUnreachableError(
            "the answer is not a job: is this a PartUV service?"
        ) from failure


def _problem(answer: Answer) -> Problem:
    try:
        return Problem.model_validate_json(answer.body)
    except ValidationError:
        text = answer.body[:200].decode("utf-8", "replace")
        return Problem(
            type="about:blank", title="HTTP error", status=answer.status, detail=text, code="http"
        )
