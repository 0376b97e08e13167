"""Operations of the gateway: a job comes in, is looked at, canceled, forgotten."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from typing import Literal, cast

from partuv_contract.jobs import JobStatus

from partuv_store.operation import Operation
from partuv_store.record import JobRecord

Outcome = Literal[
    "created",
    "cached",
    "replayed",
    "idempotency_key_reused",
    "queue_full",
    "too_many_jobs",
    "upload_lost",
]


@dataclass(frozen=True)
class Limits:
    """What one submission may find already there; 0 is no limit."""

    budget_bytes: int = 0
    queue_limit: int = 0
    owner_limit: int = 0


@dataclass(frozen=True)
class Submission:
    """A job to be. `cache_key` and `idempotency` are digests that include the owner."""

    id: str
    owner: str
    options: str
    input_sha256: str
    input_bytes: int
    input_chunks: int
    fingerprint: str
    cache_key: str
    retention_ms: int
    idempotency: str = ""
    webhook_url: str = ""
    request_id: str = ""


def admit(owner: str, announced_bytes: int, limits: Limits) -> Operation[str]:
    """May an upload begin? The code of the refusal, or nothing."""
    arguments = (
        owner,
        announced_bytes,
        limits.budget_bytes,
        limits.queue_limit,
        limits.owner_limit,
    )
    return Operation("admit", arguments, lambda reply: cast(str, reply.decode()))


def submit(submission: Submission, limits: Limits) -> Operation[tuple[Outcome, str]]:
    """Turn an upload into a job: the outcome and the id of the job that answers the request."""
    document = asdict(submission) | {
        "queue_limit": limits.queue_limit,
        "owner_limit": limits.owner_limit,
    }
    return Operation(
        "submit",
        (json.dumps(document),),
        lambda reply: (cast(Outcome, reply[0].decode()), reply[1].decode()),
    )


def published(job_id: str) -> Operation[None]:
    """Note that the broker has a message for the job."""
    return Operation("published", (job_id,), lambda _: None)


def view(job_id: str) -> Operation[JobRecord | None]:
    """The job as it is now."""

    def parse(reply: tuple[list[bytes], int]) -> JobRecord | None:
        return JobRecord.from_reply(reply[0], int(reply[1])) if reply[0] else None

    return Operation("view", (job_id,), parse)


def cancel(job_id: str) -> Operation[JobStatus | None]:
    """Stop a job; a running one stops at its worker's next beat. The status now."""
    return Operation(
        "cancel", (job_id,), lambda reply: JobStatus(reply.decode()) if reply else None
    )


def forget(job_id: str) -> Operation[bool]:
    """Remove a job and all it has."""
    return Operation("forget", (job_id,), bool)


def rate(owner: str, per_minute: int, burst: int) -> Operation[int]:
    """Count a request: 0 to let it pass, else milliseconds to wait."""
    return Operation("rate", (owner, per_minute, burst), int)
