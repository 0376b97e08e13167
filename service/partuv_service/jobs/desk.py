"""Takes orders for jobs and answers for them; REST and gRPC both come here."""

from __future__ import annotations

import asyncio
import hashlib
import json
import logging
from collections.abc import AsyncIterator
from dataclasses import dataclass

from partuv_contract.jobs import JobStatus
from partuv_contract.options import UnwrapOptions
from partuv_contract.service_errors import (
    IdempotencyError,
    InvalidParameterError,
    JobNotFoundError,
    NoResultError,
    NotFoundError,
    QueueFullError,
    RateLimitedError,
    ResultNotReadyError,
    ServiceError,
    StoreFullError,
    StoreUnavailableError,
    TooManyJobsError,
    UploadTooLargeError,
    WebhookRefusedError,
)
from partuv_store import AsyncStore, JobRecord
from partuv_store import submission as ops

from partuv_service.callers import Caller
from partuv_service.jobs.hub import Hub
from partuv_service.jobs.ids import is_job_id, new_job_id
from partuv_service.jobs.publisher import Publisher
from partuv_service.jobs.upload import Upload
from partuv_service.settings import Settings
from partuv_service.webhooks.addresses import parse_target, resolve

_log = logging.getLogger(__name__)
_REFUSALS: dict[str, tuple[type[ServiceError], str]] = {
    "queue_full": (QueueFullError, "too many jobs are waiting; try again later"),
    "too_many_jobs": (TooManyJobsError, "too many unfinished jobs with this key"),
    "store_full": (StoreFullError, "no room for this upload until other jobs expire"),
    "upload_lost": (StoreUnavailableError, "the upload got lost on its way; send it again"),
    "idempotency_key_reused": (
        IdempotencyError,
        "this idempotency key came before, with another body or other options",
    ),
}
_MAX_IDEMPOTENCY_KEY = 255
_STORE_AWAY_S = 1.0
_REREAD_S = 5.0


@dataclass(frozen=True)
class Order:
    """What a client wants done with an upload."""

    options: UnwrapOptions
    retention_s: int | None = None
    webhook_url: str | None = None
    idempotency_key: str | None = None
    request_id: str = ""


@dataclass(frozen=True)
class Accepted:
    """The job that answers an order; replayed if the order had come before."""

    record: JobRecord
    replayed: bool


@dataclass(frozen=True)
class ResultFile:
    """A file of a finished job: where it is stored, its size and digest."""

    blob: str
    bytes: int
    sha256: str


class Desk:
    """All that clients can ask of the service."""

    def __init__(
        self, store: AsyncStore, hub: Hub, publisher: Publisher, settings: Settings
    ) -> None:
        self._store = store
        self._hub = hub
        self._publisher = publisher
        self._settings = settings
        self._limits = ops.Limits(
            settings.store_budget_bytes, settings.max_queued_jobs, settings.max_jobs_per_key
        )

    async def admit(self, caller: Caller) -> None:
        """Count a request; raises `RateLimitedError` where there were too many."""
        per_minute = self._settings.rate_limit_per_minute
        if per_minute:
            burst = self._settings.rate_limit_burst
            wait_ms = await self._store.run(ops.rate(caller.id, per_minute, burst))
            if wait_ms:
                raise RateLimitedError(
                    f"at most {per_minute} requests per minute", retry_after_s=wait_ms / 1000
                )

    async def open_upload(self, caller: Caller, announced_bytes: int) -> Upload:
        """Begin an upload, unless it is clear already that it can't become a job."""
        if announced_bytes > self._settings.max_upload_bytes:
            raise UploadTooLargeError(
                f"{announced_bytes} bytes; at most {self._settings.max_upload_bytes} are taken"
            )
        refusal = await self._store.run(ops.admit(caller.id, announced_bytes, self._limits))
        if refusal:
            raise _refusal(refusal)
        return Upload(
            self._store,
            new_job_id(),
            max_bytes=self._settings.max_upload_bytes,
            budget_bytes=self._settings.store_budget_bytes,
        )

    async def check(self, order: Order) -> None:
        """Raise if an order asks for what can't be had."""
        retention_s, limit_s = order.retention_s, self._settings.retention_s
        if retention_s is not None and not 1 <= retention_s <= limit_s:
            raise InvalidParameterError(f"between 1 and {limit_s} seconds", pointer="/retention_s")
        key = order.idempotency_key
        if key is not None and not 1 <= len(key) <= _MAX_IDEMPOTENCY_KEY:
            raise InvalidParameterError(
                f"an Idempotency-Key has 1 to {_MAX_IDEMPOTENCY_KEY} characters",
                pointer="/Idempotency-Key",
            )
        if order.webhook_url is not None:
            if not self._settings.webhook_secrets:
                raise WebhookRefusedError("webhooks are off here", pointer="/webhook_url")
            await resolve(parse_target(order.webhook_url), self._settings.webhook_networks)

    async def submit(self, caller: Caller, upload: Upload, order: Order) -> Accepted:
        """Make the upload a job: from here on it is never lost."""
        received = await upload.complete()
        options = order.options.model_dump_json()
        retention_s = order.retention_s or self._settings.retention_s
        webhook_url = order.webhook_url or ""
        submission = ops.Submission(
            id=upload.job_id,
            owner=caller.id,
            options=options,
            input_sha256=received.sha256,
            input_bytes=received.bytes,
            input_chunks=received.chunks,
            fingerprint=_digest(received.sha256, options, webhook_url, retention_s),
            cache_key=_digest(caller.id, received.sha256, options),
            retention_ms=retention_s * 1000,
            idempotency=_digest(caller.id, order.idempotency_key) if order.idempotency_key else "",
            webhook_url=webhook_url,
            request_id=order.request_id,
        )
        outcome, job_id = await self._store.run(ops.submit(submission, self._limits))
        _log.info("submitted", extra={"job_id": job_id, "outcome": outcome})
        if outcome in _REFUSALS:
            raise _refusal(outcome)
        if outcome == "created":
            await self._publisher.publish(job_id, order.request_id)
        return Accepted(await self.view(caller, job_id), replayed=outcome == "replayed")

    async def view(self, caller: Caller, job_id: str) -> JobRecord:
        """The job; raises `JobNotFoundError`, also where it belongs to somebody else."""
        record = await self._store.run(ops.view(job_id)) if is_job_id(job_id) else None
        if record is None or record.owner != caller.id:
            raise JobNotFoundError(f"there is no job {job_id[:40]!r}")
        return record

    async def cancel(self, caller: Caller, job_id: str) -> JobRecord:
        """Stop the job; a running one is canceled within a second or so."""
        await self.view(caller, job_id)
        await self._store.run(ops.cancel(job_id))
        return await self.view(caller, job_id)

    async def forget(self, caller: Caller, job_id: str) -> None:
        """Stop the job and remove everything about it."""
        await self.view(caller, job_id)
        await self._store.run(ops.forget(job_id))

    async def watch(
        self, caller: Caller, job_id: str, *, silence_s: float, after: int = -1
    ) -> AsyncIterator[JobRecord | None]:
        """The job after each change later than revision `after`, until it has ended.

        None stands for `silence_s` seconds without a change. Ends early if the job is forgotten or
        the gateway closes.
        """
        clock = asyncio.get_running_loop().time
        with self._hub.listen(job_id) as listener:
            record = await self.view(caller, job_id)
            spoke_at = clock()
            while not listener.closing:
                if record.revision > after:
                    after, spoke_at = record.revision, clock()
                    yield record
                if record.status.final:
                    return
                silence_left_s = spoke_at + silence_s - clock()
                if silence_left_s <= 0:
                    spoke_at = clock()
                    yield None
                await listener.wait(max(0.0, min(silence_left_s, _REREAD_S)))
                try:
                    record = await self.view(caller, job_id)
                except JobNotFoundError:
                    return
                except StoreUnavailableError:
                    await asyncio.sleep(_STORE_AWAY_S)

    async def wait(self, caller: Caller, record: JobRecord, at_most_s: float) -> JobRecord:
        """The job when it has ended, or as it is when the time is over."""
        try:
            async with asyncio.timeout(at_most_s):
                async for seen in self.watch(caller, record.id, silence_s=at_most_s):
                    record = seen or record
        except TimeoutError:
            pass
        return record

    async def result(self, caller: Caller, job_id: str, kind: str) -> ResultFile:
        """A file of a finished job; kind is glb, png, svg or parts."""
        record = await self.view(caller, job_id)
        if not record.status.final:
            raise ResultNotReadyError(f"the job is {record.status.value}")
        if record.status is not JobStatus.SUCCEEDED or record.result is None:
            raise NoResultError(f"the job is {record.status.value}: it has no result")
        size = record.size(kind)
        if size is None:
            raise NotFoundError(f"this job has no {kind}")
        return ResultFile(f"result:{record.result}:{kind}", size, record.sha256(kind))


def _refusal(code: str) -> ServiceError:
    kind, message = _REFUSALS[code]
    return kind(message)


def _digest(*parts: str | int | None) -> str:
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()
