"""Sends Celery messages: one wake-up call per job, with the job's id and the request's."""

from __future__ import annotations

import logging

import anyio.to_thread
from celery import Celery
from kombu.exceptions import OperationalError
from partuv_store import AsyncStore
from partuv_store.broker import QUEUE, TASK, celery_settings
from partuv_store.submission import published
from redis import RedisError

_log = logging.getLogger(__name__)
_PUBLISH_TIMEOUT_S = 10.0


class Publisher:
    """Publishes to the broker without holding up the event loop."""

    def __init__(
        self, store: AsyncStore, redis_url: str, prefix: str, visibility_timeout_s: int
    ) -> None:
        self._store = store
        self._app = Celery("partuv", set_as_current=False)
        self._app.conf.update(celery_settings(redis_url, prefix, visibility_timeout_s))

    async def publish(self, job_id: str, request_id: str) -> bool:
        """Tell the workers of a job; if that fails the housekeeper tells them later."""
        try:
            with anyio.fail_after(_PUBLISH_TIMEOUT_S):
                await anyio.to_thread.run_sync(
                    self._send, job_id, request_id, abandon_on_cancel=True
                )
        except (OperationalError, RedisError, OSError) as failure:
            _log.warning("message not published", extra={"job_id": job_id, "error": repr(failure)})
            return False
        await self._store.run(published(job_id))
        return True

    def _send(self, job_id: str, request_id: str) -> None:
        headers = {"job_id": job_id, "request_id": request_id}
        self._app.send_task(TASK, args=[job_id], queue=QUEUE, headers=headers, retry=False)

    async def close(self) -> None:
        await anyio.to_thread.run_sync(self._app.close)
