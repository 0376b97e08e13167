"""Tells who waits for a job that it changed: one subscription for all of the gateway's clients."""

from __future__ import annotations

import asyncio
import logging
from collections import defaultdict
from collections.abc import Iterator
from contextlib import contextmanager

from partuv_contract.service_errors import StoreUnavailableError
from partuv_store import AsyncStore

_log = logging.getLogger(__name__)
_RESUBSCRIBE_S = 0.5


class Listener:
    """Wakes when its job changed, and when nobody could know whether it did."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._changed = asyncio.Event()

    async def wait(self, at_most_s: float) -> bool:
        """True if the job may have changed, False if the time passed without a word."""
        try:
            async with asyncio.timeout(at_most_s):
                await self._changed.wait()
        except TimeoutError:
            return False
        self._changed.clear()
        return True

    def wake(self) -> None:
        self._changed.set()

    @property
    def closing(self) -> bool:
        """True when the gateway shuts down: say goodbye to the client."""
        return self._hub.closing


class Hub:
    """Spreads the store's change notices. They may be lost; the job record is the truth."""

    def __init__(self, store: AsyncStore) -> None:
        self._store = store
        self._listeners: defaultdict[str, set[Listener]] = defaultdict(set)
        self.closing = False

    @contextmanager
    def listen(self, job_id: str) -> Iterator[Listener]:
        """Hear of a job's changes from now on."""
        listener = Listener(self)
        self._listeners[job_id].add(listener)
        try:
            yield listener
        finally:
            self._listeners[job_id].discard(listener)
            if not self._listeners[job_id]:
                del self._listeners[job_id]

    async def run(self) -> None:
        """Follow the store for ever."""
        while True:
            try:
                async with self._store.subscription() as changes:
                    self._wake_all()  # changes before the subscription went unheard
                    async for job_id in changes:
                        for listener in self._listeners.get(job_id, ()):
                            listener.wake()
            except StoreUnavailableError:
                _log.warning("subscription lost, trying again")
                await asyncio.sleep(_RESUBSCRIBE_S)

    def close(self) -> None:
        """End every wait, so that open streams end."""
        self.closing = True
        self._wake_all()

    def _wake_all(self) -> None:
        for listeners in self._listeners.values():
            for listener in listeners:
                listener.wake()
