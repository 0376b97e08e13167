"""The two ways to run operations, and the errors Redis trouble turns into."""

from __future__ import annotations

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from typing import Any, TypeVar, cast

import redis
import redis.asyncio
from partuv_contract.service_errors import StoreFullError, StoreUnavailableError
from redis.asyncio.retry import Retry as AsyncRetry
from redis.backoff import ExponentialBackoff
from redis.retry import Retry

from partuv_store.operation import Operation, script_source

T = TypeVar("T")

DEFAULT_PREFIX = "partuv:"
_TRANSIENT = (redis.ConnectionError, redis.TimeoutError, redis.BusyLoadingError)


@contextmanager
def _translated() -> Iterator[None]:
    try:
        yield
    except redis.OutOfMemoryError as failure:
        raise StoreFullError("the job store has no memory left") from failure
    except _TRANSIENT as failure:
        raise StoreUnavailableError("the job store does not answer") from failure


_CONNECTION: dict[str, Any] = {
    "socket_timeout": 10.0,
    "socket_connect_timeout": 2.0,
    "health_check_interval": 25,
    "retry_on_error": list(_TRANSIENT),
}


class Store:
    """Runs operations and waits for them; safe to share between threads."""

    def __init__(self, url: str, *, prefix: str = DEFAULT_PREFIX, retries: int = 3) -> None:
        retry = Retry(ExponentialBackoff(cap=1.0, base=0.05), retries)
        self._redis = redis.Redis.from_url(url, retry=retry, **_CONNECTION)
        self._prefix = prefix
        self._scripts: dict[str, Any] = {}

    def run(self, operation: Operation[T]) -> T:
        """Do one operation; raises `StoreUnavailableError` or `StoreFullError`."""
        script = self._scripts.get(operation.script)
        if script is None:
            script = self._redis.register_script(script_source(operation.script))
            self._scripts[operation.script] = script
        with _translated():
            return operation.parse(script(keys=[self._prefix], args=operation.arguments))

    def read_chunk(self, blob: str, index: int) -> bytes | None:
        """One chunk of a blob, or None where it is gone."""
        with _translated():
            return cast(bytes | None, self._redis.hget(f"{self._prefix}blob:{blob}", str(index)))

    def ping(self) -> None:
        """Raise unless Redis answers."""
        with _translated():
            self._redis.ping()

    def close(self) -> None:
        self._redis.close()


class AsyncStore:
    """Runs operations on the event loop it was made for."""

    def __init__(
        self,
        url: str,
        *,
        prefix: str = DEFAULT_PREFIX,
        retries: int = 1,
        max_connections: int = 256,
    ) -> None:
        retry = AsyncRetry(ExponentialBackoff(cap=1.0, base=0.05), retries)
        pool = redis.asyncio.BlockingConnectionPool.from_url(
            url, max_connections=max_connections, retry=retry, **_CONNECTION
        )
        self._redis = redis.asyncio.Redis(connection_pool=pool)
        self._prefix = prefix
        self._scripts: dict[str, Any] = {}

    async def run(self, operation: Operation[T]) -> T:
        """Do one operation; raises `StoreUnavailableError` or `StoreFullError`."""
        script = self._scripts.get(operation.script)
        if script is None:
            script = self._redis.register_script(script_source(operation.script))
            self._scripts[operation.script] = script
        with _translated():
            return operation.parse(await script(keys=[self._prefix], args=operation.arguments))

    async def read_chunk(self, blob: str, index: int) -> bytes | None:
        """One chunk of a blob, or None where it is gone."""
        with _translated():
            name = f"{self._prefix}blob:{blob}"
            return cast(bytes | None, await self._redis.hget(name, str(index)))

    async def ping(self) -> None:
        """Raise unless Redis answers."""
        with _translated():
            await self._redis.ping()

    async def waiting_messages(self, queue: str) -> list[bytes]:
        """The messages that no worker has taken yet."""
        with _translated():
            return cast(list[bytes], await self._redis.lrange(queue, 0, -1))

    @asynccontextmanager
    async def subscription(self) -> AsyncIterator[AsyncIterator[str]]:
        """Ids of jobs as they change; ends with `StoreUnavailableError` when Redis goes."""
        pubsub = self._redis.pubsub(ignore_subscribe_messages=True)
        try:
            with _translated():
                await pubsub.subscribe(f"{self._prefix}events")
            yield self._changes(pubsub)
        finally:
            await pubsub.aclose()  # type: ignore[no-untyped-call]

    @staticmethod
    async def _changes(pubsub: redis.asyncio.client.PubSub) -> AsyncIterator[str]:
        while True:
            with _translated():
                message = await pubsub.get_message(timeout=5.0)
            if message is not None:
                yield message["data"].decode()

    async def close(self) -> None:
        await self._redis.aclose()
