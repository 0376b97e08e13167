"""The child processes of a worker, seen from outside."""

from __future__ import annotations

import os
import signal
from pathlib import Path

from tests.support.service import until


def children_of(pid: int) -> list[int]:
    """Processes of a worker that run the pipeline."""
    found = []
    for entry in Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            command = (entry / "cmdline").read_bytes()
        except (OSError, IndexError, ValueError):
            continue
        if parent == pid and b"partuv_worker.run.child" in command:
            found.append(int(entry.name))
    return sorted(found)


def the_child_of(pid: int) -> int:
    """The only child of a worker with one slot, as soon as it is there."""
    return int(until(lambda: children_of(pid), 60.0)[0])


def send(pid: int, number: signal.Signals) -> None:
    """Send a signal; a process that is gone already does not mind."""
    try:
        os.kill(pid, number)
    except ProcessLookupError:
        return


def catches(pid: int, number: signal.Signals) -> bool:
    """Whether a process has a handler of its own for a signal."""
    status = Path(f"/proc/{pid}/status").read_text()
    caught = next(line for line in status.splitlines() if line.startswith("SigCgt:"))
    return bool(int(caught.split()[1], 16) >> (number - 1) & 1)
