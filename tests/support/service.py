"""The service's processes, started the way an operator starts them."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
from partuv_service.serve.redis_server import RedisServer

# Lost workers are noticed soon, and looked for often.
FAST = {"lease_s": "6", "upkeep_interval_s": "0.3", "shutdown_grace_s": "0.5"}


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def until(condition: Callable[[], Any], at_most_s: float = 20.0, every_s: float = 0.05) -> Any:
    """The first true value of the condition; fails the test if there is none in time."""
    limit = time.monotonic() + at_most_s
    while True:
        value = condition()
        if value:
            return value
        assert time.monotonic() < limit, f"not within {at_most_s} s"
        time.sleep(every_s)


class Process:
    """One process of ours, its log in a file."""

    def __init__(self, module: str, environment: dict[str, str], log: Path) -> None:
        self.log = log
        with log.open("ab") as stream:
            self._process = subprocess.Popen(
                [sys.executable, "-m", module],
                env=clean_environment() | environment,
                stdout=stream,
                stderr=stream,
                start_new_session=True,
            )

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def alive(self) -> bool:
        return self._process.poll() is None

    def kill(self) -> None:
        """SIGKILL: no goodbye."""
        self._process.kill()
        self._process.wait()

    def stop(self, at_most_s: float = 20.0) -> int:
        """SIGTERM, as an operator would; the exit code."""
        if self.alive:
            self._process.send_signal(signal.SIGTERM)
        try:
            return self._process.wait(at_most_s)
        except subprocess.TimeoutExpired:
            self.kill()
            raise


class Gateway(Process):
    """REST and gRPC on free ports."""

    def __init__(self, environment: dict[str, str], log: Path) -> None:
        self.port, self.grpc_port = free_port(), free_port()
        ports = {"PARTUV_PORT": str(self.port), "PARTUV_GRPC_PORT": str(self.grpc_port)}
        super().__init__("partuv_service", ports | environment, log)
        self.url = f"http://127.0.0.1:{self.port}"

    def wait(self) -> Gateway:
        def answers() -> bool:
            assert self.alive, self.log.read_text()[-2000:]
            try:
                return httpx.get(f"{self.url}/healthz").status_code == 200
            except httpx.TransportError:
                return False

        until(answers, 30.0)
        return self


class Stack:
    """A Redis of our own and whatever is started beside it."""

    def __init__(self, **settings: str) -> None:
        self._folder = tempfile.TemporaryDirectory(prefix="partuv-")
        self.folder = Path(self._folder.name)
        self.redis = RedisServer(self.folder / "redis", self.folder / "redis.sock")
        self.redis.start()
        self._settings = settings
        self.processes: list[Process] = []

    def environment(self, **settings: str) -> dict[str, str]:
        url = {"PARTUV_REDIS_URL": self.redis.url}
        every = self._settings | settings
        return url | {f"PARTUV_{name.upper()}": value for name, value in every.items()}

    def gateway(self, **settings: str) -> Gateway:
        gateway = Gateway(self.environment(**settings), self.folder / "gateway.log")
        self.processes.append(gateway)
        return gateway.wait()

    def worker(self, **settings: str) -> Process:
        worker = Process("partuv_worker", self.environment(**settings), self.folder / "worker.log")
        self.processes.append(worker)
        return worker

    def close(self) -> None:
        for process in self.processes:
            if process.alive:
                process.kill()
        self.redis.stop()
        self._folder.cleanup()


def clean_environment() -> dict[str, str]:
    """Ours without settings that a developer may have set."""
    return {
        name: value
        for name, value in os.environ.items()
        if not name.startswith("PARTUV_") and name != "REDIS_URL"
    }


def wait_for_workers(gateway: Gateway, count: int) -> None:
    """Until as many workers have said that they are there."""

    def there() -> bool:
        answer = httpx.get(f"{gateway.url}/readyz")
        return answer.status_code == 200 and answer.json()["workers"] >= count

    until(there, 120.0, every_s=0.2)
