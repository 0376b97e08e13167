"""The settings of a worker: one frozen object, read from the environment once."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Literal

from partuv_store import StoreSettings
from pydantic import Field
from pydantic_settings import SettingsConfigDict

from partuv_worker.glb.limits import Limits
from partuv_worker.partfield_settings import PartFieldSettings

_INHERITED = ("PATH", "LANG", "LC_ALL", "TMPDIR", "PYTHONPATH", "VIRTUAL_ENV", "LD_LIBRARY_PATH")
_THREAD_POOLS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class WorkerSettings(StoreSettings):
    """A worker's own, after those that it shares with its gateway."""

    model_config = SettingsConfigDict(env_nested_delimiter="__")

    slots: int = Field(default=1, ge=1, le=64, description="jobs that run at once")
    threads_per_job: int = Field(
        default=0, ge=0, description="threads of one job; 0: the processors shared by the slots"
    )
    job_time_limit_s: float = Field(
        default=900.0, gt=0, description="longest run of a job; the engine hurries to end before"
    )
    job_memory_bytes: int = Field(
        default=4 * 2**30, ge=0, description="memory a job may have; 0: no limit"
    )
    limits: Limits = Field(
        default_factory=Limits,
        description="bounds of an uploaded file, as PARTUV_LIMITS__FACES; see docs/gltf.md",
    )
    child_max_jobs: int = Field(
        default=50, ge=1, description="jobs after which a child process is replaced"
    )
    cancel_grace_s: float = Field(
        default=0.6, ge=0, description="time the engine has to stop before its process is killed"
    )
    shutdown_grace_s: float = Field(
        default=5.0, ge=0, description="time a running job has to end when the worker is stopped"
    )
    health_file: Path | None = Field(
        default=None, description="file that is touched while the worker consumes"
    )

    partfield_checkpoint: Path | None = Field(
        default=None, description="weights of the PartField network; none: no learned features"
    )
    partfield_device: Literal["cpu", "cuda"] = Field(
        default="cpu", description="where the network runs"
    )
    partfield_precision: Literal["float32", "half"] = Field(
        default="float32", description="half: faster, changes features by about 1 %"
    )
    partfield_points: int = Field(
        default=100_000, ge=1000, le=10_000_000, description="surface points the network sees"
    )

    @property
    def partfield(self) -> PartFieldSettings | None:
        """How the network runs here, if it does."""
        if self.partfield_checkpoint is None:
            return None
        return PartFieldSettings(
            self.partfield_checkpoint.resolve(),  # a child starts in a folder of its own
            device=self.partfield_device,
            precision=self.partfield_precision,
            points=self.partfield_points,
        )

    @property
    def threads(self) -> int:
        """Threads of one job, 0 resolved."""
        processors = len(os.sched_getaffinity(0))
        return self.threads_per_job or max(1, processors // self.slots)

    def child_environment(self) -> dict[str, str]:
        """What a child needs to know: no address, no secret."""
        kept = {name: os.environ[name] for name in _INHERITED if name in os.environ}
        # Threads that wait for each other actively take the processor from other jobs.
        pools = dict.fromkeys(_THREAD_POOLS, str(self.threads)) | {"OMP_WAIT_POLICY": "PASSIVE"}
        return kept | pools
