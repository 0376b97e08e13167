"""What a worker process holds while it runs: store, children, and the thread that says "alive"."""

from __future__ import annotations

import logging
import os
import socket
import threading
import time

from partuv_contract.logs import log_context
from partuv_contract.service_errors import StoreUnavailableError
from partuv_store import Store
from partuv_store.execution import announce, withdraw

from partuv_worker.run.children import Children
from partuv_worker.run.supervisor import Supervisor
from partuv_worker.settings import WorkerSettings

_log = logging.getLogger(__name__)
_ANNOUNCE_S = 5.0


class Runtime:
    """Made when the Celery application is; opens and starts nothing before `start`."""

    def __init__(self, settings: WorkerSettings) -> None:
        self._settings = settings
        self._name = f"{socket.gethostname()}-{os.getpid()}"
        self._busy = 0
        self._lock = threading.Lock()
        self._store: Store | None = None
        self._children: Children | None = None
        self._supervisor: Supervisor | None = None
        self._build = ""

    def start(self) -> None:
        """Start the children and begin to announce this worker."""
        settings = self._settings
        url = settings.redis_url.get_secret_value()
        self._store = Store(url, prefix=settings.key_prefix, retries=0)
        self._children = Children(settings)
        self._build = self._children.warm_up()
        self._supervisor = Supervisor(self._store, self._children, settings, self._name)
        threading.Thread(target=self._announce, name="announce", daemon=True).start()
        _log.info("ready", extra={"worker": self._name, "build": self._build})

    def handle(self, job_id: str, request_id: str) -> None:
        """Do one job, in the calling thread."""
        assert self._supervisor is not None
        with log_context(job_id=job_id, request_id=request_id):
            self._count(1)
            try:
                self._supervisor.run(job_id)
            finally:
                self._count(-1)

    def stop(self) -> None:
        """Give running jobs a moment to end, and the rest back to the line."""
        if self._supervisor is None or self._children is None or self._store is None:
            return
        self._supervisor.stopping.set()
        try:
            self._store.run(withdraw(self._name))
        except StoreUnavailableError:
            _log.warning("left without a word: the store does not answer")
        while self._busy:
            time.sleep(0.05)
        self._children.close()

    def _count(self, change: int) -> None:
        with self._lock:
            self._busy += change

    def _announce(self) -> None:
        assert self._supervisor is not None
        assert self._store is not None
        while not self._supervisor.stopping.is_set():
            description: dict[str, object] = {
                "name": self._name,
                "slots": self._settings.slots,
                "threads": self._settings.threads,
                "busy": self._busy,
                "build": self._build,
                "at": time.time(),
            }
            try:
                self._store.run(announce(self._name, description, self._build))
            except StoreUnavailableError as failure:
                _log.warning("not announced", extra={"error": failure.message})
            self._supervisor.stopping.wait(_ANNOUNCE_S)
