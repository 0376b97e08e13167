"""Jobs looked at, stopped, forgotten and followed."""

import json
import threading
import time

import httpx
import pytest
import redis
from partuv_contract.jobs import JobStatus
from partuv_store import execution

from tests.support.hand_worker import REPORT, HandWorker
from tests.support.service import Stack
from tests.support.uploads import GLB, some_glb, submit


def code_of(answer: httpx.Response) -> tuple[int, str]:
    assert answer.headers["content-type"] == "application/problem+json"
    return answer.status_code, answer.json()["code"]


def test_a_job_tells_its_life(http: httpx.Client, worker: HandWorker) -> None:
    job_id = submit(http)
    worker.claim(job_id)
    worker.beat(job_id, "search", 0.25)
    answer = http.get(f"/v1/jobs/{job_id}")
    job = answer.json()
    assert int(answer.headers["retry-after"]) >= 1
    assert (job["status"], job["stage"], job["progress"]) == ("running", "search", 0.25)
    assert (job["attempt"], job["queue_position"], job["finished_at"]) == (1, None, None)
    assert job["created_at"] <= job["started_at"]
    assert job["links"]["result"] is None


def test_a_failed_job_is_data(http: httpx.Client, worker: HandWorker) -> None:
    job_id = submit(http)
    worker.fail(job_id)
    answer = http.get(f"/v1/jobs/{job_id}")
    assert (answer.status_code, answer.json()["status"]) == (200, "failed")
    error = answer.json()["error"]
    assert (error["code"], error["status"]) == ("malformed_glb", 422)
    assert error["errors"] == [{"pointer": "/accessors/0", "detail": "accessor 0 is short"}]
    assert "retry-after" not in answer.headers
    assert code_of(http.get(f"/v1/jobs/{job_id}/result")) == (409, "no_result")


@pytest.mark.parametrize("job_id", ["job_" + "0" * 32, "job_1", "x", "job_%00", "..%2f..%2fetc"])
def test_unknown_jobs_are_not_found(http: httpx.Client, job_id: str) -> None:
    for method, path in [
        ("GET", ""),
        ("DELETE", ""),
        ("POST", "/cancel"),
        ("GET", "/events"),
        ("GET", "/result"),
        ("GET", "/preview.png"),
        ("GET", "/atlas.svg"),
        ("GET", "/parts.glb"),
    ]:
        answer = http.request(method, f"/v1/jobs/{job_id}{path}")
        assert answer.status_code == 404, path
        assert answer.json()["code"] in ("job_not_found", "not_found")


def test_canceling_is_idempotent(http: httpx.Client) -> None:
    job_id = submit(http)
    first = http.post(f"/v1/jobs/{job_id}/cancel").json()
    assert (first["status"], first["started_at"]) == ("canceled", None)
    assert http.post(f"/v1/jobs/{job_id}/cancel").json() == first


def test_canceling_a_finished_job_changes_nothing(http: httpx.Client, worker: HandWorker) -> None:
    job_id = submit(http)
    worker.succeed(job_id)
    assert http.post(f"/v1/jobs/{job_id}/cancel").json()["status"] == "succeeded"
    assert http.get(f"/v1/jobs/{job_id}/result").status_code == 200


def test_deleting_leaves_no_key(http: httpx.Client, worker: HandWorker, stack: Stack) -> None:
    job_id = submit(http)
    worker.succeed(job_id)
    assert http.delete(f"/v1/jobs/{job_id}").status_code == 204
    assert code_of(http.get(f"/v1/jobs/{job_id}")) == (404, "job_not_found")
    assert code_of(http.delete(f"/v1/jobs/{job_id}")) == (404, "job_not_found")
    with redis.Redis.from_url(stack.redis.url) as raw:
        assert raw.keys(f"*{job_id}*") == []
        assert not any(job_id.encode() in name for name in raw.hkeys("partuv:ledger"))


def test_retention_can_be_shorter(http: httpx.Client, worker: HandWorker) -> None:
    content = some_glb()
    answer = http.post("/v1/unwrap?retention_s=1", content=content, headers=GLB)
    job_id = answer.json()["id"]
    worker.succeed(job_id)
    assert http.get(f"/v1/jobs/{job_id}/result").status_code == 200
    time.sleep(1.0)
    limit = time.monotonic() + 5.0
    while http.get(f"/v1/jobs/{job_id}").status_code != 404:
        assert time.monotonic() < limit
        time.sleep(0.1)


def read_events(answer: httpx.Response) -> list[tuple[int, str, dict]]:
    events, fields = [], {}
    for line in answer.iter_lines():
        name, _, value = line.partition(": ")
        if name:
            fields[name] = value
        elif "event" in fields:
            events.append((int(fields["id"]), fields["event"], json.loads(fields["data"])))
            fields = {}
    return events


def test_events_tell_every_change_and_end(http: httpx.Client, worker: HandWorker) -> None:
    job_id = submit(http)

    def work() -> None:
        for step in range(5):
            time.sleep(0.1)
            if step == 0:
                worker.claim(job_id)
            else:
                worker.beat(job_id, "search", step / 5)
        time.sleep(0.1)
        worker.store.run(_finish(job_id))

    thread = threading.Thread(target=work)
    thread.start()
    with http.stream("GET", f"/v1/jobs/{job_id}/events") as answer:
        assert answer.headers["content-type"].startswith("text/event-stream")
        assert answer.headers["x-accel-buffering"] == "no"
        events = read_events(answer)
    thread.join()
    names = [name for _, name, _ in events]
    assert names == ["status", "status", *["progress"] * 4, "done"]
    ids = [number for number, _, _ in events]
    assert ids == sorted(set(ids))
    progress = [job["progress"] for _, _, job in events]
    assert progress == sorted(progress)
    assert events[-1][2]["status"] == "failed"


def _finish(job_id: str):
    ending = execution.Ending(JobStatus.FAILED, "internal", {"error": json.dumps(_PROBLEM)})
    return execution.finish(job_id, 1, ending)


_PROBLEM = {"type": "urn:x", "title": "x", "status": 500, "detail": "x", "code": "internal"}


def test_events_resume_after_the_last_id(http: httpx.Client, worker: HandWorker) -> None:
    job_id = submit(http)
    with http.stream("GET", f"/v1/jobs/{job_id}/events") as answer:
        lines = answer.iter_lines()
        last = next(line for line in lines if line.startswith("id: "))[4:]
    worker.succeed(job_id)
    headers = {"Last-Event-ID": last}
    with http.stream("GET", f"/v1/jobs/{job_id}/events", headers=headers) as answer:
        events = read_events(answer)
    assert [name for _, name, _ in events] == ["done"]
    assert events[0][0] > int(last)
    headers = {"Last-Event-ID": str(events[0][0])}
    with http.stream("GET", f"/v1/jobs/{job_id}/events", headers=headers) as answer:
        assert read_events(answer) == [], "seen all, and it has ended"


def test_events_of_a_deleted_job_end(http: httpx.Client) -> None:
    job_id = submit(http)
    deleting = threading.Timer(0.3, lambda: http.delete(f"/v1/jobs/{job_id}"))
    deleting.start()
    with http.stream("GET", f"/v1/jobs/{job_id}/events") as answer:
        assert [name for _, name, _ in read_events(answer)] == ["status"]
    deleting.join()


def test_the_report_is_on_the_job(http: httpx.Client, worker: HandWorker) -> None:
    job_id = submit(http)
    worker.succeed(job_id)
    job = http.get(f"/v1/jobs/{job_id}").json()
    assert (job["report"], job["input"]["faces"], job["progress"]) == (REPORT, 12, 1.0)
