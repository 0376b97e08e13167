"""A child for every slot, ready before the job comes."""

from __future__ import annotations

import threading

from partuv_worker.run.child_process import ChildProcess
from partuv_worker.run.wire import LinkClosed
from partuv_worker.settings import WorkerSettings

_TRIES = 3


class Children:
    """Hands out children and takes them back; a child is replaced when it is spent."""

    def __init__(self, settings: WorkerSettings) -> None:
        self._settings = settings
        self._lock = threading.Lock()
        self._idle: list[ChildProcess] = []
        self._all: set[ChildProcess] = set()
        self._closed = False

    def warm_up(self) -> str:
        """Have a child ready and one more on its way per slot; the build they run.

        Raises `LinkClosed` if none can be started.
        """
        for left in reversed(range(_TRIES)):
            try:
                child = self.take()
                break
            except LinkClosed:
                if not left:
                    raise
        for _ in range(self._settings.slots - 1):
            self._replace()
        self.give_back(child, fit=True)
        return child.build

    def take(self) -> ChildProcess:
        """A child that is ready; raises `LinkClosed` if it can't start."""
        while True:
            with self._lock:
                child = self._idle.pop(0) if self._idle else None
            if child is None:
                child = self._start()
            try:
                child.wait_ready()
            except LinkClosed:
                self._end(child)
                raise
            if child.alive:
                return child
            self._end(child)

    def give_back(self, child: ChildProcess, *, fit: bool) -> None:
        """A child that did its job; one that is dead, stuck, spent or bloated is replaced."""
        limit_bytes = self._settings.job_memory_bytes
        bloated = limit_bytes > 0 and child.memory_bytes() > limit_bytes // 2
        if fit and not bloated and child.jobs_done < self._settings.child_max_jobs:
            with self._lock:
                self._idle.append(child)
            return
        self._end(child)
        self._replace()

    def close(self) -> None:
        """End them all; none is started any more."""
        with self._lock:
            self._closed = True
            children, self._idle = list(self._all), []
        for child in children:
            self._end(child)

    def _end(self, child: ChildProcess) -> None:
        child.end()
        with self._lock:
            self._all.discard(child)

    def _replace(self) -> None:
        """Start a child for the next job; whoever takes it waits until it is ready."""
        with self._lock:
            if self._closed:
                return
        child = self._start()
        with self._lock:
            self._idle.append(child)

    def _start(self) -> ChildProcess:
        settings = self._settings
        child = ChildProcess(
            memory_bytes=settings.job_memory_bytes,
            limits=settings.limits,
            environment=settings.child_environment(),
            partfield=settings.partfield,
        )
        with self._lock:
            self._all.add(child)
        return child
