"""The supervisor's side of a child process: start it, feed it, watch it, end it."""

from __future__ import annotations

import logging
import re
import signal
import socket
import subprocess
import sys
import tempfile
import threading
from collections import deque
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from partuv_worker.glb.limits import Limits
from partuv_worker.partfield_settings import PartFieldSettings
from partuv_worker.run.starved import tells_of_no_memory
from partuv_worker.run.wire import Frame, Link, LinkClosed

_log = logging.getLogger(__name__)
_START_TIMEOUT_S = 120.0  # torch takes its time
_MAX_LOG_LINE = 2000
_KEPT_LINES = 20
_LISTEN_ON_S = 1.0


class ChildProcess:
    """One child; used by one supervisor at a time."""

    def __init__(
        self,
        *,
        memory_bytes: int,
        limits: Limits,
        environment: dict[str, str],
        partfield: PartFieldSettings | None = None,
    ) -> None:
        self.jobs_done = 0
        self.build = ""
        self._folder = tempfile.TemporaryDirectory(prefix="partuv-job-")
        ours, theirs = socket.socketpair()
        self._link = Link(ours)
        command = [sys.executable, "-m", "partuv_worker.run.child"]
        settings = [limits.model_dump_json()]
        if partfield is not None:
            settings.append(partfield.to_json())
        with theirs:
            self._process = subprocess.Popen(
                [*command, str(theirs.fileno()), str(memory_bytes), *settings],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                pass_fds=[theirs.fileno()],
                cwd=self._folder.name,
                env=environment,
                start_new_session=True,  # a Ctrl-C in the terminal is the worker's business
            )
        self._last_words: deque[str] = deque(maxlen=_KEPT_LINES)
        self._listener = threading.Thread(target=self._drain_log, name="child-log", daemon=True)
        self._listener.start()

    @property
    def pid(self) -> int:
        return self._process.pid

    @property
    def ending(self) -> str:
        """How the process ended, for the log."""
        code = self._process.poll()
        if code is None:
            return "running"
        return signal.Signals(-code).name if code < 0 else f"exit code {code}"

    @property
    def starved(self) -> bool:
        """True if its last words were of memory it did not get."""
        return any(tells_of_no_memory(line) for line in self._last_words)

    @property
    def alive(self) -> bool:
        return self._process.poll() is None

    def wait_ready(self) -> None:
        """Wait until it has loaded the engine; raises `LinkClosed` if it never does."""
        if self.build:
            return
        frame = self._link.receive(_START_TIMEOUT_S)
        if frame is None or frame.kind != "ready":
            raise LinkClosed("the child did not become ready")
        self.build = str(frame.header["build"])

    def start_job(
        self, job_id: str, options: dict[str, Any], threads: int, chunks: Iterable[bytes]
    ) -> None:
        """Send a job."""
        self._link.send("job", id=job_id, options=options, threads=threads)
        for chunk in chunks:
            self._link.send("chunk", chunk)
        self._link.send("run")

    def cancel(self, job_id: str) -> None:
        """Ask it to stop."""
        self._link.send("cancel", id=job_id)

    def receive(self, at_most_s: float) -> Frame | None:
        """Its next word, None if it is silent; raises `LinkClosed` if it died."""
        return self._link.receive(at_most_s)

    def memory_bytes(self) -> int:
        """Memory it holds now, by the measure its limit counts; 0 if that can't be known."""
        try:
            status = Path(f"/proc/{self.pid}/status").read_text()
        except OSError:
            return 0
        found = re.search(r"^VmData:\s+(\d+) kB$", status, re.MULTILINE)
        return int(found[1]) * 1024 if found else 0

    def end(self) -> None:
        """Kill it, whatever it does."""
        if self.alive:
            self._process.kill()
        self._process.wait()
        self._listener.join(_LISTEN_ON_S)
        self._link.close()
        self._folder.cleanup()

    def _drain_log(self) -> None:
        assert self._process.stderr is not None
        with self._process.stderr as stream:
            for line in stream:
                text = line[:_MAX_LOG_LINE].decode("utf-8", "replace").rstrip()
                self._last_words.append(text)
                _log.info("child says", extra={"child": self.pid, "line": text})
