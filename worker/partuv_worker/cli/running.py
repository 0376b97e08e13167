"""A run with a bar that moves and a Ctrl-C that is heard."""

from __future__ import annotations

import signal
import threading
from typing import Protocol, TypeVar

from rich.console import Console
from rich.progress import BarColumn, TextColumn, TimeElapsedColumn
from rich.progress import Progress as Bar

from partuv_worker.progress import Progress

_POLL_S = 0.1
Result = TypeVar("Result", covariant=True)


class Run(Protocol[Result]):
    """What can be watched and stopped from another thread."""

    @property
    def progress(self) -> Progress: ...

    def cancel(self) -> None: ...

    def run(self, data: bytes) -> Result: ...


def run_with_progress(work: Run[Result], data: bytes, console: Console) -> Result:
    """Run in a thread of its own; raises what the run raises."""
    outcome: list[Result | BaseException] = []

    def target() -> None:
        try:
            outcome.append(work.run(data))
        except BaseException as failure:  # handed to the main thread below
            outcome.append(failure)

    worker = threading.Thread(target=target, name="run")
    columns = (BarColumn(), TextColumn("{task.percentage:>3.0f}%"), TimeElapsedColumn())
    bar = Bar(*columns, TextColumn("{task.description}"), console=console, transient=True)
    previous = signal.signal(signal.SIGINT, lambda *_: work.cancel())
    try:
        with bar:
            task = bar.add_task("reading", total=1.0)
            worker.start()
            while worker.is_alive():
                worker.join(_POLL_S)
                fraction, stage = work.progress
                bar.update(task, completed=fraction, description=stage)
    finally:
        signal.signal(signal.SIGINT, previous)
    if isinstance(outcome[0], BaseException):
        raise outcome[0]
    return outcome[0]
