"""How time and memory of the whole command grow with the faces of one mesh.

    python -m bench.growth [--mesh MESH.glb] [--most 1050000] [--limit-s 1800]

The mesh is a GLB, or a creature of blended limbs. Every face is split in four, and the creature's
new vertices are pulled onto its surface, until it has no more faces than `--most`. Every size is
unwrapped from GLB to GLB in a process of its own, by the default options. An exponent is the slope
of the logarithm of the seconds over that of the faces, by least squares: 1 is linear.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_worker.glb.accessors import FLOAT, UNSIGNED_INT
from partuv_worker.glb.fresh import FreshGlb
from partuv_worker.measure import side_ends
from partuv_worker.pipeline import unwrap_glb
from partuv_worker.samples.surface_nets import extract_surface

from bench.compare.adapters.exchange import Stopwatch, peak_rss_mb
from bench.compare.meshes import MeshFile

Array = NDArray[Any]

# Of the grid that the creature is first meshed on, in 3,972 faces; chosen so that the net touches
# itself in no edge.
_CELL = 0.0994
_BLEND = 0.06

# Start, end and radius of each limb.
_LIMBS = (
    ((-0.7, 0.0, 0.0), (0.7, 0.1, 0.0), 0.45),
    ((0.9, 0.45, 0.0), (1.15, 0.65, 0.0), 0.32),
    ((1.1, 0.85, 0.25), (1.1, 1.2, 0.35), 0.16),
    ((1.1, 0.85, -0.25), (1.1, 1.2, -0.35), 0.16),
    ((0.6, -0.3, 0.3), (0.75, -1.1, 0.4), 0.18),
    ((0.6, -0.3, -0.3), (0.75, -1.1, -0.4), 0.18),
    ((-0.6, -0.3, 0.3), (-0.7, -1.1, 0.4), 0.18),
    ((-0.6, -0.3, -0.3), (-0.7, -1.1, -0.4), 0.18),
    ((-1.1, 0.1, 0.0), (-1.8, 0.9, 0.1), 0.18),
)
_LOW, _HIGH = (-2.1, -1.5, -0.8), (1.7, 1.6, 0.8)


@dataclass(frozen=True)
class Run:
    """One size, as its process tells of it."""

    faces: int
    charts: int
    seconds: float
    cpu_seconds: float
    peak_rss_mb: float
    stages: dict[str, float]  # seconds


def creature(points: Array) -> Array:
    """Negative inside. The limbs are united smoothly, and rippled."""
    distances = []
    for start, end, radius in _LIMBS:
        axis = np.subtract(end, start)
        along = np.clip((points - start) @ axis / (axis @ axis), 0, 1)
        distances.append(np.linalg.norm(points - start - along[:, None] * axis, axis=1) - radius)
    least = np.min(distances, axis=0)
    united = least - _BLEND * np.log(np.sum(np.exp((least - distances) / _BLEND), axis=0))
    ripples: Array = united + 0.008 * np.sin(11 * points).prod(axis=1)
    return ripples


def creature_mesh() -> tuple[Array, Array]:
    """The coarsest creature, closed."""
    positions, faces, _ = extract_surface(creature, _LOW, _HIGH, _CELL)
    return positions.astype(np.float64), faces.astype(np.int64)


def split(positions: Array, faces: Array) -> tuple[Array, Array]:
    """Every face in four, at the middles of its sides."""
    sides = np.sort(side_ends(faces), axis=1)
    edges, number = np.unique(sides, axis=0, return_inverse=True)
    middle = len(positions) + number.reshape(-1, 3)
    before = np.roll(middle, 1, axis=1)
    corners = np.stack([faces, middle, before], axis=2).reshape(-1, 3)
    return (
        np.concatenate([positions, positions[edges].mean(axis=1)]),
        np.concatenate([corners, middle]),
    )


def _pulled(points: Array) -> Array:
    """A Newton step towards the creature's surface."""
    step = 1e-5
    value = creature(points)
    offsets = step * np.eye(3)
    gradient = np.stack([(creature(points + one) - value) / step for one in offsets], axis=1)
    pulled: Array = points - (value / (gradient**2).sum(axis=1))[:, None] * gradient
    return pulled


def as_glb(positions: Array, faces: Array) -> bytes:
    """The GLB of one mesh with normals, as most have."""
    corners = positions[faces]
    crossed = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.stack(
        [np.bincount(faces.ravel(), np.repeat(column, 3), len(positions)) for column in crossed.T],
        axis=1,
    )
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    glb = FreshGlb()
    attributes = {
        "POSITION": glb.positions(positions.astype(np.float32)),
        "NORMAL": glb.attribute(normals.astype(np.float32), FLOAT, "VEC3"),
    }
    indices = glb.indices(faces.astype(np.uint32), UNSIGNED_INT)
    return glb.finish(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": attributes, "indices": indices}]}],
        }
    )


def meshes_of(source: Path | None, most_faces: int) -> Iterator[tuple[Array, Array]]:
    """One mesh in growing numbers of faces."""
    is_creature = source is None
    positions, faces = creature_mesh() if source is None else MeshFile("", source).arrays()
    while len(faces) <= most_faces:
        yield positions, faces
        positions, faces = split(positions, faces)
        if is_creature:
            positions = _pulled(_pulled(positions))


def unwrap_here(path: Path) -> Run:
    data = path.read_bytes()
    stopwatch = Stopwatch()
    with stopwatch.running():
        report = unwrap_glb(data, threads=os.cpu_count() or 1).report
    return Run(
        report.faces,
        report.chart_count,
        stopwatch.seconds,
        stopwatch.cpu_seconds,
        peak_rss_mb(),
        dict(report.seconds),
    )


def unwrap_apart(path: Path, limit_s: float) -> Run | None:
    """In a process of its own; none if that takes too long."""
    command = [sys.executable, "-m", "bench.growth", "--unwrap", str(path)]
    try:
        done = subprocess.run(
            command, stdout=subprocess.PIPE, text=True, check=True, timeout=limit_s
        )
    except subprocess.TimeoutExpired:
        return None
    return Run(**json.loads(done.stdout))


def runs_of(source: Path | None, most_faces: int, limit_s: float) -> Iterator[Run]:
    """All sizes, up to the first that takes too long."""
    with tempfile.TemporaryDirectory() as scratch:
        glb = Path(scratch) / "mesh.glb"
        for positions, faces in meshes_of(source, most_faces):
            glb.write_bytes(as_glb(positions, faces))
            print(f"{len(faces):,} faces ...\r", end="", file=sys.stderr, flush=True)
            run = unwrap_apart(glb, limit_s)
            if run is None:
                print(f"{len(faces):,} faces: no result after {limit_s:g} s", file=sys.stderr)
                return
            yield run


def exponent(faces: Sequence[int], seconds: Sequence[float]) -> float:
    """Of the power law through the points, by least squares of the logarithms."""
    return float(np.polyfit(np.log(faces), np.log(np.maximum(seconds, 1e-9)), 1)[0])


def print_sizes(runs: Iterable[Run]) -> Iterator[Run]:
    """A row per size as soon as it is known."""
    print("| faces | charts | wall s | CPU s | CPU us / face | peak MB |")
    print("| ---: |" + " ---: |" * 5, flush=True)
    for run in runs:
        print(
            f"| {run.faces:,} | {run.charts} | {run.seconds:.2f} | {run.cpu_seconds:.2f} | "
            f"{1e6 * run.cpu_seconds / run.faces:.1f} | {run.peak_rss_mb:,.0f} |",
            flush=True,
        )
        yield run


def print_stages(runs: Sequence[Run]) -> None:
    """Seconds of every stage by size, those of most time at the largest size first."""
    faces = [run.faces for run in runs]
    print("\n| seconds of | " + " | ".join(f"{count:,}" for count in faces), end="")
    print(" | exponent | of the last step |\n| --- |" + " ---: |" * (len(faces) + 2))
    rows = {"all, wall": [run.seconds for run in runs]}
    rows["all, CPU"] = [run.cpu_seconds for run in runs]
    for stage in sorted(runs[-1].stages, key=lambda name: -runs[-1].stages[name]):
        rows[stage] = [run.stages.get(stage, 0.0) for run in runs]
    for name, seconds in rows.items():
        cells = [f"{value:.3f}" for value in seconds]
        cells += [f"{exponent(faces, seconds):.2f}", f"{exponent(faces[-2:], seconds[-2:]):.2f}"]
        print(f"| {name} | " + " | ".join(cells) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="bench.growth",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--mesh", type=Path, help="a GLB to split instead of the creature")
    parser.add_argument("--most", type=int, default=1_050_000, help="faces")
    parser.add_argument("--limit-s", type=float, default=1800.0, help="per size")
    parser.add_argument("--unwrap", type=Path, help=argparse.SUPPRESS)
    parsed = parser.parse_args()
    if parsed.unwrap:
        print(json.dumps(asdict(unwrap_here(parsed.unwrap))))
        return
    runs = list(print_sizes(runs_of(parsed.mesh, parsed.most, parsed.limit_s)))
    if len(runs) > 1:
        print_stages(runs)


if __name__ == "__main__":
    main()
