"""Whatever dies in the middle, every accepted job ends once, correctly, and leaves nothing."""

import os
import random
import signal
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import redis

from tests.support.breakable import Breakable, work_a_shift
from tests.support.children import children_of, send, the_child_of
from tests.support.follow import GLB, ended, look, running, submit
from tests.support.meshes import large, quick, slow
from tests.support.service import Gateway, until, wait_for_workers


@pytest.fixture(scope="module")
def broken() -> Iterator[Breakable]:
    broken = Breakable()
    yield broken
    broken.close()


@pytest.fixture(autouse=True)
def _nothing_stays(broken: Breakable) -> Iterator[None]:
    """After each test: the service works, and the store is empty once the jobs are deleted."""
    yield
    job = ended(broken.http, submit(broken.http, quick(999)))
    assert job["status"] == "succeeded"
    broken.delete_all()


def test_a_killed_child_costs_one_attempt(broken: Breakable) -> None:
    job_id = submit(broken.http, slow(21), deadline_s=2)
    running(broken.http, job_id)
    send(the_child_of(broken.worker.pid), signal.SIGKILL)
    job = ended(broken.http, job_id)
    assert (job["status"], job["attempt"]) == ("succeeded", 2)
    assert broken.worker.alive


def test_a_job_that_kills_twice_is_given_up(broken: Breakable) -> None:
    job_id = submit(broken.http, slow(22))
    for attempt in (1, 2):
        until(lambda n=attempt: look(broken.http, job_id)["attempt"] == n, 60.0)
        running(broken.http, job_id)
        send(the_child_of(broken.worker.pid), signal.SIGSEGV)
    job = ended(broken.http, job_id)
    assert (job["status"], job["error"]["code"], job["attempt"]) == ("failed", "worker_lost", 2)


def test_a_killed_worker_loses_nothing(broken: Breakable) -> None:
    job_id = submit(broken.http, slow(23), deadline_s=2)
    waiting = submit(broken.http, quick(24))
    running(broken.http, job_id)
    child = the_child_of(broken.worker.pid)
    folder = Path(os.readlink(f"/proc/{child}/cwd"))
    broken.worker.kill()
    until(lambda: not _alive(child), 10.0)
    assert not folder.exists()
    broken.restart_worker()
    job = ended(broken.http, job_id)
    assert (job["status"], job["attempt"]) == ("succeeded", 2)
    assert ended(broken.http, waiting)["attempt"] == 1


def _alive(pid: int) -> bool:
    try:
        with open(f"/proc/{pid}/stat") as stat:
            return stat.read().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_a_worker_that_is_stopped_gives_its_job_back(broken: Breakable) -> None:
    job_id = submit(broken.http, slow(25), deadline_s=6)
    running(broken.http, job_id)
    assert broken.worker.stop() == 0
    assert look(broken.http, job_id)["status"] == "queued"
    broken.restart_worker()
    job = ended(broken.http, job_id)
    assert job["status"] == "succeeded"
    with redis.Redis.from_url(broken.stack.redis.url) as raw:
        assert raw.hget(f"partuv:job:{job_id}", "losses") == b"0", "nobody died"


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGKILL])
def test_a_restarted_redis_loses_nothing(broken: Breakable, number: signal.Signals) -> None:
    job_id = submit(broken.http, slow(26 + number), deadline_s=3)
    waiting = submit(broken.http, quick(60 + number))
    running(broken.http, job_id)
    process = broken.stack.redis.process
    assert process is not None
    process.send_signal(number)
    process.wait()
    answer = broken.http.get(f"/v1/jobs/{job_id}")
    assert (answer.status_code, answer.json()["code"]) == (503, "store_unavailable")
    assert int(answer.headers["retry-after"]) >= 1
    assert broken.http.get("/healthz").status_code == 200
    refused = broken.http.post("/v1/unwrap", content=quick(1), headers=GLB)
    assert refused.status_code == 503
    broken.stack.redis.start()
    job = ended(broken.http, job_id)
    assert (job["status"], job["attempt"]) == ("succeeded", 1), "the worker just went on"
    assert ended(broken.http, waiting)["status"] == "succeeded"


def test_a_restarted_gateway_loses_nothing(broken: Breakable) -> None:
    job_id = submit(broken.http, slow(28), deadline_s=3)
    running(broken.http, job_id)
    broken.gateway.kill()
    broken.restart_gateway()
    job = ended(broken.http, job_id)
    assert (job["status"], job["attempt"]) == ("succeeded", 1)


def test_a_gateway_that_stops_ends_its_streams(broken: Breakable) -> None:
    job_id = submit(broken.http, slow(29), deadline_s=4)
    second = broken.stack.gateway()
    lines: list[str] = []

    def listen() -> None:
        with httpx.stream("GET", f"{second.url}/v1/jobs/{job_id}/events", timeout=60.0) as answer:
            for line in answer.iter_lines():
                lines.append(line)

    listener = threading.Thread(target=listen)
    listener.start()
    running(broken.http, job_id)
    until(lambda: lines)
    started = time.monotonic()
    assert second.stop() == 0
    listener.join(10.0)
    assert not listener.is_alive()
    assert time.monotonic() - started < 10.0
    broken.http.delete(f"/v1/jobs/{job_id}")


def test_cancels_at_any_moment(broken: Breakable) -> None:
    dice = random.Random(5)
    for round_ in range(12):
        job_id = submit(broken.http, slow(70 + round_ % 3), deadline_s=20)
        time.sleep(dice.uniform(0.0, 0.7))
        broken.http.post(f"/v1/jobs/{job_id}/cancel")
        assert ended(broken.http, job_id, 15.0)["status"] == "canceled"
        assert broken.http.get(f"/v1/jobs/{job_id}/result").json()["code"] == "no_result"


def test_the_same_upload_from_everywhere_at_once(broken: Breakable) -> None:
    source, ids = quick(90), []

    def send_one() -> None:
        with httpx.Client(base_url=broken.gateway.url, timeout=60.0) as http:
            ids.append(submit(http, source))

    threads = [threading.Thread(target=send_one) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    jobs = [ended(broken.http, job_id) for job_id in ids]
    assert {job["status"] for job in jobs} == {"succeeded"}
    etags = {broken.http.head(job["links"]["result"]).headers["etag"] for job in jobs}
    assert len(etags) == 1


def test_memory_is_limited_per_job(broken: Breakable) -> None:
    small = broken.stack.worker(slots="1", job_memory_bytes=str(200 * 2**20), key_prefix="mem:")
    gateway = broken.stack.gateway(key_prefix="mem:")
    wait_for_workers(gateway, 1)
    with httpx.Client(base_url=gateway.url, timeout=60.0) as http:
        job = ended(http, submit(http, large(31)))
        assert (job["status"], job["error"]["code"]) == ("failed", "out_of_memory"), job
        assert job["attempt"] == 1
        assert ended(http, submit(http, quick(32)))["status"] == "succeeded"
    assert small.stop() == 0
    gateway.stop()


def test_time_is_limited_even_for_an_engine_that_hangs(broken: Breakable) -> None:
    worker = broken.stack.worker(slots="1", job_time_limit_s="3", key_prefix="time:")
    gateway = broken.stack.gateway(key_prefix="time:")
    wait_for_workers(gateway, 1)
    with httpx.Client(base_url=gateway.url, timeout=60.0) as http:
        job_id = submit(http, slow(33))
        running(http, job_id)
        send(the_child_of(worker.pid), signal.SIGSTOP)
        job = ended(http, job_id, 30.0)
        assert (job["status"], job["error"]["code"]) == ("failed", "time_limit_exceeded")
        assert ended(http, submit(http, quick(34)))["status"] == "succeeded"
    assert worker.stop() == 0
    assert not children_of(worker.pid)
    gateway.stop()


def test_a_shift_with_accidents_loses_nothing(broken: Breakable) -> None:
    """Many jobs, two workers, and somebody who keeps killing; bench/soak.py does more of it."""
    shift = work_a_shift(broken, jobs=30, seed=1, pause_s=3.0)
    assert shift.endings == shift.outcomes.total() == 30, "each ended, and once"
    assert shift.outcomes.keys() <= {"succeeded", "worker_lost"}, "lost twice is lost"
    assert shift.outcomes["succeeded"] > 20
    assert shift.killed_children + shift.killed_workers >= 2


def test_gateways_share_the_work(broken: Breakable) -> None:
    other: Gateway = broken.stack.gateway()
    with httpx.Client(base_url=other.url, timeout=60.0) as http:
        job_id = submit(http, quick(95))
        assert ended(broken.http, job_id)["status"] == "succeeded"
        assert http.get(f"/v1/jobs/{job_id}/result").content.startswith(b"glTF")
    other.stop()
