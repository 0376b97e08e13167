"""Operations that keep the promises when a process breaks them: the gateway runs them regularly."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import Any

from partuv_store.operation import Operation


@dataclass(frozen=True)
class Survey:
    """The whole store at one moment."""

    waiting: int
    running: int
    stored_bytes: int
    metrics: dict[str, float]
    workers: list[dict[str, Any]]
    webhooks_waiting: int


def sweep(
    *, max_losses: int, lost_error: str, queue_error: str, lease_s: float
) -> Operation[tuple[int, int]]:
    """Requeue or fail jobs whose worker went silent, end expired ones; how many of each."""
    return Operation(
        "sweep",
        (max_losses, lost_error, queue_error, int(lease_s * 1000)),
        lambda reply: (int(reply[0]), int(reply[1])),
    )


def reconcile() -> Operation[int]:
    """Take blobs that expired by themselves out of the ledger; how many."""
    return Operation("reconcile", (), int)


def unpublished(older_than_s: float) -> Operation[tuple[list[str], list[str]]]:
    """Waiting jobs without a message, and those whose message was published longer ago."""
    return Operation(
        "unpublished",
        (int(older_than_s * 1000),),
        lambda reply: ([i.decode() for i in reply[0]], [i.decode() for i in reply[1]]),
    )


def due_webhooks(*, lease_s: float, at_most: int) -> Operation[list[str]]:
    """Take finished jobs whose webhook is to be called now."""
    return Operation(
        "due_webhooks",
        (int(lease_s * 1000), at_most),
        lambda reply: [job_id.decode() for job_id in reply],
    )


def webhook_tried(
    job_id: str, delivery: dict[str, Any], *, retry_in_s: float | None, outcome: str
) -> Operation[bool]:
    """Log a delivery on the job and plan the next try, if there is to be one."""
    retry_ms = -1 if retry_in_s is None else int(retry_in_s * 1000)
    return Operation("webhook_tried", (job_id, json.dumps(delivery), retry_ms, outcome), bool)


def survey() -> Operation[Survey]:
    """Everything readiness and metrics need, in one reading."""

    def parse(reply: list[Any]) -> Survey:
        flat = [value.decode() for value in reply[3]]
        return Survey(
            waiting=int(reply[0]),
            running=int(reply[1]),
            stored_bytes=int(reply[2]),
            metrics={name: float(value) for name, value in zip(flat[::2], flat[1::2], strict=True)},
            workers=[json.loads(worker) for worker in reply[4]],
            webhooks_waiting=int(reply[5]),
        )

    return Operation("survey", (), parse)
