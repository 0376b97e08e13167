"""A child for every slot, ready before the job comes."""

from __future__ import annotations

import threading

from partuv_worker.run.child_process import ChildProcess
from partuv_worker.settings import WorkerSettings


class Children:
    """Hands out children and takes them back; a child is replaced when it is spent."""

    def __init__(self, settings: WorkerSettings) -> None:
        self._settings = settings
        self._lock = threading.Lock()
        self._idle: list[ChildProcess] = []
        self._all: set[ChildProcess] = set()

    def warm_up(self) -> str:
        """Start a child per slot; the build they run. Raises `LinkClosed` if none can start."""
        started = [self._start() for _ in range(self._settings.slots)]
        for child in started:
            child.wait_ready()
            self.give_back(child)
        return started[0].build

    def take(self) -> ChildProcess:
        """An idle child, or a new one; raises `LinkClosed` if it can't start."""
        while True:
            with self._lock:
                child = self._idle.pop() if self._idle else None
            if child is None:
                child = self._start()
                try:
                    child.wait_ready()
                except BaseException:
                    self.discard(child)
                    raise
            if child.alive:
                return child
            self.discard(child)

    def give_back(self, child: ChildProcess) -> None:
        """A child that is fit for another job."""
        limit_bytes = self._settings.job_memory_bytes
        bloated = limit_bytes and child.memory_bytes() > limit_bytes // 2
        if bloated or child.jobs_done >= self._settings.child_max_jobs:
            self.discard(child)
            return
        with self._lock:
            self._idle.append(child)

    def discard(self, child: ChildProcess) -> None:
        """A child that is dead, spent or stuck."""
        child.end()
        with self._lock:
            self._all.discard(child)

    def close(self) -> None:
        """End them all."""
        with self._lock:
            children, self._idle = list(self._all), []
        for child in children:
            self.discard(child)

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
