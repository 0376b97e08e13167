"""What a tool's process gets and gives: runs in every tool's environment, so only numpy is known.

python -m bench.compare.adapters.TOOL MESH.npz MESH.glb ATLAS.npz [ARGUMENT ...]
"""

from __future__ import annotations

import resource
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


@dataclass(frozen=True)
class Mesh:
    positions: Array  # V x 3 float64, no two equal
    faces: Array  # F x 3 int32
    glb: Path  # where it was read from


@dataclass
class Stopwatch:
    """Time on the clock, and on all processors together: the latter hardly feels other programs."""

    seconds: float = 0.0
    cpu_seconds: float = 0.0

    @contextmanager
    def running(self) -> Iterator[None]:
        wall, cpu = time.perf_counter(), time.process_time()
        yield
        self.seconds += time.perf_counter() - wall
        self.cpu_seconds += time.process_time() - cpu


@dataclass(frozen=True)
class Atlas:
    """UVs per corner; with a mesh of its own where the tool does not keep the faces it got."""

    corner_uv: Array  # F x 3 x 2
    positions: Array | None = None
    faces: Array | None = None
    stopwatch: Stopwatch | None = None  # if not all that the call took is the tool's


def answer(unwrap: Callable[[Mesh, list[str]], Atlas]) -> None:
    """Unwrap the mesh that the command line names."""
    source, glb, target, *arguments = sys.argv[1:]
    with np.load(source) as stored:
        mesh = Mesh(stored["positions"], stored["faces"], Path(glb))
    whole_call = Stopwatch()
    with whole_call.running():
        atlas = unwrap(mesh, arguments)
    stopwatch = atlas.stopwatch or whole_call
    np.savez(
        target,
        positions=mesh.positions if atlas.positions is None else atlas.positions,
        faces=mesh.faces if atlas.faces is None else atlas.faces,
        corner_uv=atlas.corner_uv,
        seconds=stopwatch.seconds,
        cpu_seconds=stopwatch.cpu_seconds,
        peak_rss_mb=peak_rss_mb(),
    )


def peak_rss_mb() -> float:
    """Of this process alone: on Linux `ru_maxrss` begins with what the starting process had."""
    status = Path("/proc/self/status")
    if status.exists():
        kilobytes = next(line for line in status.read_text().splitlines() if "VmHWM" in line)
        return int(kilobytes.split()[1]) / 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def square_texels(uv: Array, width: int, height: int) -> Array:
    """UVs that were divided by an atlas' width and height, with one unit for both axes again."""
    scaled: Array = np.asarray(uv, np.float64) * (width, height) / max(width, height)
    return scaled
