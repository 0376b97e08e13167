"""Operations of a worker: take a job, keep it, end it. `attempt` is the fencing token."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Literal, cast

from partuv_contract.jobs import JobStatus

from partuv_store.operation import Operation
from partuv_store.record import JobRecord

Pulse = Literal["go", "cancel", "lost"]


@dataclass(frozen=True)
class Ending:
    """How an attempt ended. `build` is empty where the result is not to be cached."""

    status: JobStatus
    code: str = ""
    fields: dict[str, str] = field(default_factory=dict)
    build: str = ""
    metrics: dict[str, float] = field(default_factory=dict)


def claim(job_id: str, worker: str, lease_s: float) -> Operation[JobRecord | None]:
    """Take a queued job; None where it is gone, finished or in other hands."""

    def parse(reply: tuple[bytes, list[bytes]]) -> JobRecord | None:
        return JobRecord.from_reply(reply[1]) if reply[0] == b"claimed" else None

    return Operation("claim", (job_id, worker, int(lease_s * 1000)), parse)


def beat(
    job_id: str, attempt: int, lease_s: float, stage: str, progress: float
) -> Operation[Pulse]:
    """Keep the lease, tell stage and progress, learn whether to go on."""
    return Operation(
        "beat",
        (job_id, attempt, int(lease_s * 1000), stage, progress),
        lambda reply: cast(Pulse, reply.decode()),
    )


def finish(job_id: str, attempt: int, ending: Ending) -> Operation[bool]:
    """End the job, once; False where this attempt no longer counts."""
    document = {
        "status": ending.status.value,
        "code": ending.code,
        "fields": ending.fields,
        "build": ending.build,
        "metrics": ending.metrics,
    }
    return Operation(
        "finish", (job_id, attempt, json.dumps(document)), lambda reply: bool(reply == b"finished")
    )


def give_back(
    job_id: str, attempt: int, *, max_losses: int = 0, error: str = ""
) -> Operation[JobStatus | None]:
    """Put the job back into the line.

    With `max_losses` this counts as a loss of the worker, and the last one fails the job with
    `error`. The status afterwards, or None where the job was not this attempt's any more.
    """

    def parse(reply: bytes) -> JobStatus | None:
        return None if reply == b"lost" else JobStatus(reply.decode())

    return Operation("give_back", (job_id, attempt, max_losses, error), parse)


def announce(worker: str, description: dict[str, object], build: str) -> Operation[None]:
    """Tell that this worker lives, for a minute; `build` names what it computes with."""
    return Operation("announce", (worker, json.dumps(description), build), lambda _: None)


def withdraw(worker: str) -> Operation[None]:
    """Tell that this worker leaves."""
    return Operation("withdraw", (worker,), lambda _: None)
