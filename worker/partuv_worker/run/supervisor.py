"""Sees one job through: claims it, has a child run it, and ends it exactly once.

The child may crash, hang or outgrow its memory; the job may be canceled, forgotten or given to
somebody else; Redis may go away for a while. None of it reaches another job.
"""

from __future__ import annotations

import json
import logging
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any, TypeVar

from partuv_contract.errors import PartuvError
from partuv_contract.jobs import JobStatus
from partuv_contract.problem import Problem
from partuv_contract.service_errors import (
    JobError,
    OutOfMemoryError,
    StoreFullError,
    StoreUnavailableError,
    TimeLimitError,
    WorkerLostError,
)
from partuv_store import JobRecord, Operation, Store, blobs
from partuv_store import execution as ops

from partuv_worker.run.child_process import ChildProcess
from partuv_worker.run.children import Children
from partuv_worker.run.figures import metrics_of
from partuv_worker.run.wire import Frame, LinkClosed
from partuv_worker.settings import WorkerSettings

T = TypeVar("T")
_log = logging.getLogger(__name__)
_BEAT_S = 0.25
_LISTEN_S = 0.05
_PATIENCE_S = 300.0  # as long as this a finished result waits for Redis to come back
_ENGINE_SHARE = 0.85  # of the time limit; what is left is for reading, writing and drawing
_UNFIT_AFTER = ("internal", "out_of_memory")  # codes that leave a child in doubt
_NEAR_LIMIT = 0.7  # a child that dies with so much of its memory used died of that


class JobLost(Exception):
    """The job is in other hands, ended or forgotten: nothing to report."""


class WorkerStopping(Exception):
    """The worker is shut down: the job goes back into the line."""


@dataclass
class _Run:
    """One attempt at one job."""

    record: JobRecord
    child: ChildProcess
    deadline_s: float
    started: float = field(default_factory=time.monotonic)
    stage: str = "starting"
    progress: float = 0.0
    next_beat: float = 0.0
    cancel_at: float | None = None
    stop_at: float | None = None
    peak_bytes: int = 0
    parts: dict[str, int] = field(default_factory=dict)
    answered: bool = False

    @property
    def seconds(self) -> float:
        return time.monotonic() - self.started


class Supervisor:
    """Runs jobs for one worker process, one per calling thread."""

    def __init__(
        self, store: Store, children: Children, settings: WorkerSettings, worker: str
    ) -> None:
        self._store = store
        self._children = children
        self._settings = settings
        self._worker = worker
        self.stopping = threading.Event()

    def run(self, job_id: str) -> None:
        """Do the job, unless it is done, gone, or somebody else's."""
        try:
            # Before the claim: a job in our hands must not wait for a process to start.
            child = self._children.take()
        except LinkClosed:
            _log.exception("no child can be started; the job waits")
            return
        fit = True
        try:
            # The name holds the thread: two deliveries of one message must not both own the job.
            worker = f"{self._worker}/{threading.get_ident()}"
            record = self._do(ops.claim(job_id, worker, self._settings.lease_s))
            if record is None:
                _log.info("nothing to do")
            else:
                fit = self._see_through(record, child)
        except BaseException:
            fit = False
            raise
        finally:
            self._children.give_back(child, fit=fit)

    def _see_through(self, record: JobRecord, child: ChildProcess) -> bool:
        """Do a job that is ours; true if the child may do another."""
        extra: dict[str, object] = {"attempt": record.attempt}
        _log.info("started", extra=extra)
        run = _Run(record, child, self._deadline_s(record))
        try:
            ending = self._attempt(run)
        except JobLost:
            _log.info("job is no longer ours", extra=extra)
            return False
        except WorkerStopping:
            self._do(ops.give_back(record.id, record.attempt))
            _log.info("given back", extra=extra)
            return False
        if ending is None:
            self._lose(record)
            return False
        if self._do(ops.finish(record.id, record.attempt, ending)):
            extra |= {"status": ending.status.value} | (
                {"code": ending.code} if ending.code else {}
            )
            _log.info("ended", extra=extra)
        return run.answered and ending.code not in _UNFIT_AFTER

    def _attempt(self, run: _Run) -> ops.Ending | None:
        """How the attempt ended; None if the child died of the job."""
        options = run.record.document("options") | {"deadline_s": run.deadline_s}
        try:
            run.child.start_job(run.record.id, options, self._settings.threads, self._input(run))
            return self._follow(run)
        except LinkClosed:
            return self._after_death(run)
        except JobError as failure:
            return _failed(failure)
        finally:
            run.child.jobs_done += 1

    def _deadline_s(self, record: JobRecord) -> float:
        """When the engine is to hurry: as asked, and in time for the limit."""
        asked_s = record.document("options")["deadline_s"]
        limit_s = self._settings.job_time_limit_s * _ENGINE_SHARE
        return limit_s if asked_s is None else min(float(asked_s), limit_s)

    def _follow(self, run: _Run) -> ops.Ending:
        """Listen to the child until it has ended the job, keeping the lease meanwhile."""
        while True:
            frame = run.child.receive(_LISTEN_S)
            run.peak_bytes = max(run.peak_bytes, run.child.memory_bytes())
            if frame is not None:
                ending = self._take(run, frame)
                if ending is not None:
                    return ending
            self._keep(run)
            if run.cancel_at is not None and time.monotonic() > run.cancel_at:
                return ops.Ending(JobStatus.CANCELED)

    def _take(self, run: _Run, frame: Frame) -> ops.Ending | None:
        if frame.kind == "progress":
            run.stage, run.progress = str(frame.header["stage"]), float(frame.header["fraction"])
        elif frame.kind == "part":
            self._store_part(run, str(frame.header["file"]), frame.payload)
        elif frame.kind == "failed":
            run.answered = True
            problem = Problem.model_validate(frame.header["problem"])
            if problem.code == "cancelled":
                return ops.Ending(JobStatus.CANCELED)
            return _failed_with(problem)
        elif frame.kind == "done":
            run.answered = True
            return self._success(run, frame.header)
        return None

    def _success(self, run: _Run, header: dict[str, Any]) -> ops.Ending:
        report = header["report"]
        fields = {"report": json.dumps(report), "faces": str(int(report["faces"]))}
        for name, size in header["sizes"].items():
            fields[f"{name}_bytes"] = str(int(size))
            fields[f"{name}_sha256"] = str(header["sha256"][name])
        # A run that was cut short gives another result on another day: not for the cache.
        in_time = run.seconds < run.deadline_s
        return ops.Ending(
            JobStatus.SUCCEEDED,
            fields=fields,
            build=run.child.build if in_time else "",
            metrics=metrics_of(report),
        )

    def _store_part(self, run: _Run, name: str, content: bytes) -> None:
        index = run.parts.get(name, 0)
        run.parts[name] = index + 1
        blob = blobs.part_name(run.record.id, run.record.attempt, name)
        try:
            self._do(blobs.append(blob, index, content))
        except StoreFullError as failure:
            raise OutOfMemoryError("the job store has no room for the result") from failure

    def _keep(self, run: _Run) -> None:
        """Keep the lease and the limits, every now and then."""
        if time.monotonic() >= run.next_beat:
            self._beat(run)
            self._check_limits(run)
            run.next_beat = time.monotonic() + _BEAT_S

    def _beat(self, run: _Run) -> None:
        beat = ops.beat(
            run.record.id, run.record.attempt, self._settings.lease_s, run.stage, run.progress
        )
        try:
            pulse = self._store.run(beat)
        except StoreUnavailableError:
            pulse = "go"  # Redis is away; the engine need not wait for it
        if pulse == "lost":
            raise JobLost
        if pulse == "cancel" and run.cancel_at is None:
            run.child.cancel(run.record.id)
            run.cancel_at = time.monotonic() + self._settings.cancel_grace_s

    def _check_limits(self, run: _Run) -> None:
        if run.seconds > self._settings.job_time_limit_s:
            raise TimeLimitError(f"the job ran longer than {self._settings.job_time_limit_s:g} s")
        if self.stopping.is_set():
            run.stop_at = run.stop_at or time.monotonic() + self._settings.shutdown_grace_s
            if time.monotonic() >= run.stop_at:
                raise WorkerStopping

    def _after_death(self, run: _Run) -> ops.Ending | None:
        """The child is gone: of its memory, of a cancel's kill, or of a bug."""
        run.child.end()
        limit_bytes = self._settings.job_memory_bytes
        extra = {"ending": run.child.ending, "peak_bytes": run.peak_bytes}
        _log.warning("the child died", extra=extra | {"attempt": run.record.attempt})
        if run.cancel_at is not None:
            return ops.Ending(JobStatus.CANCELED)
        if run.child.starved or (limit_bytes and run.peak_bytes > limit_bytes * _NEAR_LIMIT):
            return _failed(OutOfMemoryError("the job needs more memory than a job may have"))
        return None

    def _lose(self, record: JobRecord) -> None:
        losses = self._settings.max_losses
        error = WorkerLostError(f"the process that ran this job died, {losses} times")
        problem = Problem.of(error).model_dump_json()
        status = self._do(
            ops.give_back(record.id, record.attempt, max_losses=losses, error=problem)
        )
        _log.warning("attempt lost", extra={"attempt": record.attempt, "status": status})

    def _input(self, run: _Run) -> Iterator[bytes]:
        blob = blobs.upload_name(run.record.id)
        for index in range(run.record.input_chunks):
            chunk = self._patiently(partial(self._store.read_chunk, blob, index))
            if chunk is None:
                raise JobLost  # forgotten while it was read
            yield chunk
            self._keep(run)

    def _do(self, operation: Operation[T]) -> T:
        return self._patiently(lambda: self._store.run(operation))

    def _patiently(self, step: Callable[[], T]) -> T:
        """Take a step, waiting for Redis if it is away."""
        give_up = time.monotonic() + _PATIENCE_S
        while True:
            try:
                return step()
            except StoreUnavailableError:
                if time.monotonic() > give_up or self.stopping.is_set():
                    raise
            time.sleep(_BEAT_S)


def _failed(failure: PartuvError) -> ops.Ending:
    return _failed_with(Problem.of(failure))


def _failed_with(problem: Problem) -> ops.Ending:
    return ops.Ending(JobStatus.FAILED, problem.code, {"error": problem.model_dump_json()})
