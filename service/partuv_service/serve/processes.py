"""Processes that live and die with us."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import time
from collections.abc import Mapping, Sequence
from typing import IO

_PR_SET_PDEATHSIG = 1
_QUICK_DEATH_S = 10.0
_QUICK_DEATHS = 3


def die_with_parent() -> None:
    """For `preexec_fn`: end with SIGTERM when the process that started us is gone (Linux)."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)


class Kept:
    """A process that is started again when it dies, unless it keeps dying at once.

    It has a session of its own: Ctrl-C reaches only us, and we decide who goes first.
    """

    def __init__(
        self, name: str, command: Sequence[str], environment: Mapping[str, str], log: IO[bytes]
    ) -> None:
        self.name = name
        self._command = command
        self._environment = {**os.environ, **environment}
        self._log = log
        self._started = 0.0
        self._quick_deaths = 0
        self.process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        """Start it."""
        self._started = time.monotonic()
        self.process = subprocess.Popen(
            self._command,
            stdin=subprocess.DEVNULL,
            stdout=self._log,
            stderr=self._log,
            env=self._environment,
            start_new_session=True,
            preexec_fn=die_with_parent,
        )

    def keep(self) -> bool:
        """Start it again if it died; False when that has become pointless."""
        assert self.process is not None
        if self.process.poll() is None:
            return True
        quick = time.monotonic() - self._started < _QUICK_DEATH_S
        self._quick_deaths = self._quick_deaths + 1 if quick else 1
        if self._quick_deaths >= _QUICK_DEATHS:
            return False
        self.start()
        return True

    def stop(self, patience_s: float) -> None:
        """Ask it to end, and see to it that it does."""
        if self.process is None:
            return
        self.process.terminate()
        try:
            self.process.wait(patience_s)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
