"""A service to be broken, and somebody who breaks it while it works."""

from __future__ import annotations

import random
import signal
import time
from collections import Counter
from typing import NamedTuple

import httpx
import redis
from prometheus_client.parser import text_string_to_metric_families

from tests.support.children import catches, children_of, send
from tests.support.follow import ended, look, submit
from tests.support.meshes import quick, slow
from tests.support.service import FAST, Process, Stack, until, wait_for_workers

_PATIENCE_S = 300.0  # with a job, once all before it have ended


class Breakable:
    """A service of its own; one slot, so that everybody knows which child it is."""

    def __init__(self, **settings: str) -> None:
        self.stack = Stack(**FAST, **settings)
        self.gateway = self.stack.gateway()
        self.worker = self.start_worker()
        wait_for_workers(self.gateway, 1)
        self.http = httpx.Client(base_url=self.gateway.url, timeout=60.0)

    def start_worker(self) -> Process:
        return self.stack.worker(slots="1", threads_per_job="1")

    def restart_worker(self) -> None:
        self.worker = self.start_worker()

    def restart_gateway(self) -> None:
        self.gateway = self.stack.gateway()
        self.http.close()
        self.http = httpx.Client(base_url=self.gateway.url, timeout=60.0)

    def keys(self) -> set[str]:
        """What the store holds, without what belongs to the service as a whole."""
        with redis.Redis.from_url(self.stack.redis.url, decode_responses=True) as raw:
            found = set(raw.keys("*"))
        shared = ("partuv:mq:", "partuv:worker", "partuv:metrics", "partuv:build")
        return {key for key in found if key.startswith("partuv:") and not key.startswith(shared)}

    def delete_all(self) -> None:
        """Delete every job; returns when nothing is left of them, fails if something stays."""
        for key in self.keys():
            if key.startswith("partuv:job:"):
                self.http.delete(f"/v1/jobs/{key.rpartition(':')[2]}")
        until(lambda: self.keys() == set(), 30.0)

    def endings(self) -> float:
        """How many times a job has ended so far."""
        families = text_string_to_metric_families(self.http.get("/metrics").text)
        samples = [sample for family in families for sample in family.samples]
        return sum(one.value for one in samples if one.name == "uv_jobs_finished_total")

    def close(self) -> None:
        self.http.close()
        self.stack.close()


class Shift(NamedTuple):
    """What became of the jobs of a shift."""

    outcomes: Counter[str]
    attempts: Counter[int]
    killed_children: int
    killed_workers: int
    endings: float
    seconds: float


def work_a_shift(broken: Breakable, *, jobs: int, seed: int, pause_s: float) -> Shift:
    """Jobs through two workers, while now a worker, now its child is killed, until all have ended.

    One job in ten is a slow one. A success that has no whole result counts as `broken`.
    """
    dice, before, started = random.Random(seed), broken.endings(), time.monotonic()
    workers = [broken.worker, broken.start_worker()]
    open_jobs = [
        submit(broken.http, slow(seed * 1000 + n), deadline_s=1)
        if n % 10 == 9
        else submit(broken.http, quick(seed * 1000 + n))
        for n in range(jobs)
    ]
    outcomes: Counter[str] = Counter()
    attempts: Counter[int] = Counter()
    killed = {"child": 0, "worker": 0}
    next_kill = started + dice.uniform(0.2, pause_s)
    for job_id in open_jobs:
        job, limit = None, time.monotonic() + _PATIENCE_S
        while job is None:
            job = _ended_by(broken.http, job_id, next_kill)
            assert time.monotonic() < limit, f"hangs: {look(broken.http, job_id)}"
            if time.monotonic() >= next_kill:
                killed[_kill_one(dice, workers, broken)] += 1
                next_kill = time.monotonic() + dice.uniform(0.2, pause_s)
        attempts[job["attempt"]] += 1
        outcomes[_outcome(broken.http, job)] += 1
    broken.worker = workers[0]
    # One that took a killed one's place a moment ago has to be up before it can end in order.
    until(lambda: catches(workers[1].pid, signal.SIGTERM))
    assert workers[1].stop() == 0
    return Shift(
        outcomes,
        attempts,
        killed["child"],
        killed["worker"],
        broken.endings() - before,
        time.monotonic() - started,
    )


def _ended_by(http: httpx.Client, job_id: str, moment: float) -> dict | None:
    try:
        return ended(http, job_id, max(0.1, moment - time.monotonic()))
    except AssertionError:
        return None


def _kill_one(dice: random.Random, workers: list[Process], broken: Breakable) -> str:
    which = dice.randrange(2)
    if dice.random() < 0.5:
        for child in children_of(workers[which].pid):
            send(child, signal.SIGKILL)
        return "child"
    workers[which].kill()
    workers[which] = broken.start_worker()
    return "worker"


def _outcome(http: httpx.Client, job: dict) -> str:
    if job["status"] != "succeeded":
        return str(job["error"]["code"] if job["error"] else job["status"])
    glb = http.get(job["links"]["result"]).content
    whole = glb[:4] == b"glTF" and int.from_bytes(glb[8:12], "little") == len(glb)
    return "succeeded" if whole else "broken"
