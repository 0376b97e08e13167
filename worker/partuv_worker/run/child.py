"""The child process: runs the pipeline, one job after another, and knows nothing else.

Started as `python -m partuv_worker.run.child SOCKET MEMORY_BYTES LIMITS [PARTFIELD]`. Here, and
nowhere else in the worker, the engine and torch are loaded. If the supervisor dies the child ends
at once.
"""

from __future__ import annotations

import faulthandler
import hashlib
import logging
import os
import queue
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any

from partuv_contract.errors import CancelledError, FeaturesError, PartuvError
from partuv_contract.options import UnwrapOptions
from partuv_contract.problem import Problem
from partuv_contract.service_errors import OutOfMemoryError
from partuv_store.blobs import CHUNK_BYTES

from partuv_worker.features import PartFieldSettings, Priors
from partuv_worker.glb.limits import Limits
from partuv_worker.run import sandbox
from partuv_worker.run.starved import tells_of_no_memory
from partuv_worker.run.wire import Frame, Link, LinkClosed

_PROGRESS_INTERVAL_S = 0.2
_DRAW_FROM = 0.97  # of the bar
_PREVIEW_TEXELS = 512  # a larger picture takes longer than many an unwrap; the SVG is there too
_log = logging.getLogger(__name__)


@dataclass
class Job:
    """What the supervisor sent."""

    id: str
    options: UnwrapOptions
    threads: int
    data: bytearray = field(default_factory=bytearray)


class Child:
    """Receives jobs and cancels in one thread, works in another."""

    def __init__(
        self, link: Link, limits: Limits, partfield: PartFieldSettings | None = None
    ) -> None:
        from partuv_worker import pipeline  # loads the engine

        self._pipeline = pipeline
        self._limits = limits
        self._priors = Priors(partfield)
        self._build = build_id()
        if partfield is not None:
            self._load_partfield()
        self._link = link
        self._jobs: queue.SimpleQueue[Job] = queue.SimpleQueue()
        self._lock = threading.Lock()
        self._current: Any = None
        self._canceled: set[str] = set()

    def serve(self) -> None:
        """Work until the supervisor hangs up."""
        threading.Thread(target=self._listen, name="listen", daemon=True).start()
        self._link.send("ready", build=self._build)
        while True:
            self._work(self._jobs.get())

    def _load_partfield(self) -> None:
        """Weights are checked now: a bad file shows in the log at start, not at the first job."""
        try:
            self._build += f"-{self._priors.partfield().version.removeprefix('sha256:')[:12]}"
        except FeaturesError as failure:
            _log.error("no learned part features: %s [%s]", failure, failure.code)

    def _listen(self) -> None:
        incoming: Job | None = None
        try:
            while True:
                frame = self._link.receive()
                assert frame is not None
                if frame.kind == "job":
                    options = UnwrapOptions.model_validate(frame.header["options"])
                    incoming = Job(frame.header["id"], options, frame.header["threads"])
                elif frame.kind == "chunk" and incoming is not None:
                    incoming.data += frame.payload
                elif frame.kind == "run" and incoming is not None:
                    self._jobs.put(incoming)
                    incoming = None
                elif frame.kind == "cancel":
                    self._cancel(frame)
        except LinkClosed:
            with suppress(OSError):
                os.rmdir(os.getcwd())  # ours, and empty; a supervisor that was killed left it
            os._exit(0)  # nobody is left to work for, wherever the engine is now

    def _cancel(self, frame: Frame) -> None:
        with self._lock:
            self._canceled.add(frame.header["id"])
            if self._current is not None:
                self._current.cancel()

    def _work(self, job: Job) -> None:
        try:
            self._unwrap(job)
        except PartuvError as failure:
            self._send_error(failure)
        except Exception as failure:
            _log.exception("the pipeline broke")
            if tells_of_no_memory(repr(failure)):
                self._send_error(OutOfMemoryError("the job needs more memory than a job may have"))
            else:
                self._send_error(PartuvError("an unexpected error, see the worker's log"))

    def _unwrap(self, job: Job) -> None:
        unwrap = self._pipeline.Unwrap(
            job.options, threads=job.threads, limits=self._limits, priors=self._priors
        )
        with self._lock:
            if job.id in self._canceled:
                raise CancelledError("canceled before it began")
            self._current = unwrap
        drawing = threading.Event()

        def progress() -> tuple[float, str]:
            if drawing.is_set():
                return _DRAW_FROM, "drawing"
            fraction, stage = unwrap.progress
            return fraction * _DRAW_FROM, stage

        try:
            with self._telling(progress):
                result = unwrap.run(bytes(job.data))
                drawing.set()
                drawings = {"png": result.preview_png(_PREVIEW_TEXELS), "svg": result.preview_svg()}
                if job.options.parts != "search":
                    drawings["parts"] = result.parts_glb()
        finally:
            with self._lock:
                self._current = None
                self._canceled.discard(job.id)
        files = {"glb": result.glb, **drawings}
        for name, content in files.items():
            for start in range(0, len(content), CHUNK_BYTES):
                self._link.send("part", content[start : start + CHUNK_BYTES], file=name)
        self._link.send(
            "done",
            report=result.report.model_dump(mode="json"),
            sizes={name: len(content) for name, content in files.items()},
            sha256={name: hashlib.sha256(content).hexdigest() for name, content in files.items()},
        )

    @contextmanager
    def _telling(self, progress: Callable[[], tuple[float, str]]) -> Iterator[None]:
        ended = threading.Event()

        def tell() -> None:
            told = None
            while not ended.wait(_PROGRESS_INTERVAL_S):
                fraction, stage = progress()
                if (fraction, stage) != told:
                    told = (fraction, stage)
                    self._link.send("progress", fraction=fraction, stage=stage)

        teller = threading.Thread(target=tell, name="progress", daemon=True)
        teller.start()
        try:
            yield
        finally:
            ended.set()
            teller.join()

    def _send_error(self, failure: PartuvError) -> None:
        self._link.send("failed", problem=Problem.of(failure).model_dump(mode="json"))


def build_id() -> str:
    """Names the code that computes results: equal builds give equal bytes for equal input."""
    import partuv_contract
    import partuv_engine

    import partuv_worker

    digest = hashlib.sha256()
    for package in (partuv_contract, partuv_engine, partuv_worker):
        for folder in sorted({str(Path(place)) for place in package.__path__}):
            for path in sorted(Path(folder).rglob("*")):
                if path.suffix in (".py", ".so", ".json"):
                    digest.update(path.name.encode() + path.read_bytes())
    return f"{version('partuv-service')}-{digest.hexdigest()[:12]}"


def main() -> None:
    """Entry of the child process."""
    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    faulthandler.enable()  # a crash in native code leaves a trace in the worker's log
    descriptor, memory_bytes = int(sys.argv[1]), int(sys.argv[2])
    limits = Limits.model_validate_json(sys.argv[3])
    sandbox.enter(memory_bytes)
    partfield = PartFieldSettings.from_json(sys.argv[4]) if len(sys.argv) > 4 else None
    Child(Link(socket.socket(fileno=descriptor)), limits, partfield).serve()


if __name__ == "__main__":
    main()
