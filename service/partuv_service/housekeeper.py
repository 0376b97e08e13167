"""Keeps the promises when another process breaks down: the part of the gateway that never rests.

Several gateways may run this at the same time: every step is atomic and harmless to repeat.
"""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable, Coroutine

from partuv_contract.problem import Problem
from partuv_contract.service_errors import QueueTimeoutError, UnavailableError, WorkerLostError
from partuv_store import AsyncStore, upkeep
from partuv_store.broker import queue_key
from partuv_store.submission import view

from partuv_service.jobs.ids import ids_in
from partuv_service.jobs.publisher import Publisher
from partuv_service.jobs.view import to_job
from partuv_service.settings import Settings
from partuv_service.webhooks.sender import WebhookSender

_log = logging.getLogger(__name__)
_RECONCILE_INTERVAL_S = 15.0
_MESSAGE_AGE_S = 10.0  # a worker that took a younger message may be about to claim the job
_WEBHOOK_INTERVAL_S = 0.5
_WEBHOOK_LEASE_S = 60.0
_WEBHOOKS_AT_ONCE = 16


class Housekeeper:
    """Requeues, republishes, expires and calls back."""

    def __init__(
        self,
        store: AsyncStore,
        publisher: Publisher,
        sender: WebhookSender | None,
        settings: Settings,
    ) -> None:
        self._store = store
        self._publisher = publisher
        self._sender = sender
        self._settings = settings
        self._lost = _error_text(
            WorkerLostError(f"{settings.max_losses} workers died or fell silent with this job")
        )
        self._late = _error_text(QueueTimeoutError("no worker took the job before it expired"))

    def duties(self) -> list[Coroutine[None, None, None]]:
        """What never ends; to be run side by side."""
        duties = [
            _regularly(self._upkeep, self._settings.upkeep_interval_s),
            _regularly(self._reconcile, _RECONCILE_INTERVAL_S),
        ]
        if self._sender is not None:
            duties.append(_regularly(self._call_back, _WEBHOOK_INTERVAL_S))
        return duties

    async def _upkeep(self) -> None:
        reaped, expired = await self._store.run(
            upkeep.sweep(
                max_losses=self._settings.max_losses,
                lost_error=self._lost,
                queue_error=self._late,
                lease_s=self._settings.lease_s,
            )
        )
        if reaped or expired:
            _log.info("swept", extra={"lost_workers": reaped, "expired_jobs": expired})
        without_message, _ = await self._store.run(upkeep.unpublished(_MESSAGE_AGE_S))
        for job_id in without_message:
            await self._publish(job_id)

    async def _reconcile(self) -> None:
        """Find jobs whose message is lost, and blobs that nobody finished.

        A message that a worker took, while its job still waits, may have died with that worker; if
        it did not, the second one finds the job taken.
        """
        await self._store.run(upkeep.reconcile())
        _, published = await self._store.run(upkeep.unpublished(_MESSAGE_AGE_S))
        if not published:
            return
        queue = queue_key(self._settings.key_prefix)
        announced = ids_in(b"".join(await self._store.waiting_messages(queue)))
        for job_id in published:
            if job_id not in announced:
                await self._publish(job_id)

    async def _publish(self, job_id: str) -> None:
        record = await self._store.run(view(job_id))
        if record is not None and await self._publisher.publish(job_id, record.request_id):
            _log.info("message sent again", extra={"job_id": job_id})

    async def _call_back(self) -> None:
        due = await self._store.run(
            upkeep.due_webhooks(lease_s=_WEBHOOK_LEASE_S, at_most=_WEBHOOKS_AT_ONCE)
        )
        await asyncio.gather(*(self._deliver(job_id) for job_id in due))

    async def _deliver(self, job_id: str) -> None:
        record = await self._store.run(view(job_id))
        if record is None or record.webhook_url is None or self._sender is None:
            return
        attempt = len(record.document("deliveries") or []) + 1
        delivery = await self._sender.deliver(record.webhook_url, to_job(record), attempt)
        retry_in_s = None if delivery.delivered else self._next_try_s(attempt)
        outcome = "delivered" if delivery.delivered else "given_up"
        if retry_in_s is not None:
            outcome = "failed"
        await self._store.run(
            upkeep.webhook_tried(
                job_id, delivery.model_dump(mode="json"), retry_in_s=retry_in_s, outcome=outcome
            )
        )

    def _next_try_s(self, attempt: int) -> float | None:
        delays = self._settings.webhook_retry_delays_s
        return delays[attempt - 1] if attempt <= len(delays) else None


async def _regularly(step: Callable[[], Awaitable[None]], interval_s: float) -> None:
    while True:
        try:
            await step()
        except UnavailableError as failure:
            _log.warning("upkeep waits for the store", extra={"error": failure.message})
        except Exception:
            # One bad record must not end the upkeep of all others.
            _log.exception("upkeep step failed")
        await asyncio.sleep(interval_s)


def _error_text(error: WorkerLostError | QueueTimeoutError) -> str:
    return Problem.of(error).model_dump_json()
