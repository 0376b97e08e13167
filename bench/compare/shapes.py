"""Own meshes for a run without a folder: smooth at three sizes, noisy, with needle triangles."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_worker.samples.robot import robot
from partuv_worker.samples.surface_nets import extract_surface
from partuv_worker.samples.write import Part, write_parts
from scipy.spatial import cKDTree

Array = NDArray[Any]

_GREY = (0.6, 0.6, 0.6)
_TUBE_RADIUS = 0.45
_SPIKES = 24


def knot(cell: float) -> bytes:
    """A trefoil knot from a grid of this cell size."""
    turn = np.linspace(0, 2 * np.pi, 4000, endpoint=False)
    line = np.stack(
        [
            np.sin(turn) + 2 * np.sin(2 * turn),
            np.cos(turn) - 2 * np.cos(2 * turn),
            -np.sin(3 * turn),
        ],
        axis=1,
    )
    tree = cKDTree(line)

    def distance(points: NDArray[np.float64]) -> NDArray[np.float64]:
        nearest: NDArray[np.float64] = tree.query(points)[0]
        return nearest - _TUBE_RADIUS

    return write_parts([Part("Knot", _GREY, *extract_surface(distance, (-4,) * 3, (4,) * 3, cell))])


def noisy_robot() -> bytes:
    """The sample with white noise on its vertices, as raw iso-surfaces have it."""
    random = np.random.default_rng(1)
    parts = [
        Part(
            part.name,
            part.color,
            (part.positions + random.normal(0, 0.006, part.positions.shape)).astype(np.float32),
            part.faces,
            part.normals,
        )
        for part in robot()
    ]
    return write_parts(parts)


def gear() -> bytes:
    """A toothed ring as a CAD kernel would triangulate it: flat faces and needles."""
    around = np.arange(4 * _SPIKES) * (2 * np.pi / (4 * _SPIKES))
    radius = np.where(np.arange(4 * _SPIKES) % 4 < 2, 1.0, 0.8)
    circle = np.stack([np.cos(around), np.sin(around)], axis=1)
    rings = [
        np.column_stack([scale[:, None] * circle, np.full(len(around), height)])
        for height in (0.0, 0.3)
        for scale in (radius, np.full(len(around), 0.35))
    ]
    outer_low, inner_low, outer_high, inner_high = range(4)
    strips = (
        (outer_low, outer_high),
        (outer_high, inner_high),
        (inner_high, inner_low),
        (inner_low, outer_low),
    )
    faces = np.concatenate([_strip(a, b, len(around)) for a, b in strips]).astype(np.uint32)
    positions = np.concatenate(rings).astype(np.float32)
    normals = np.tile(np.array([0, 0, 1], np.float32), (len(positions), 1))
    return write_parts([Part("Gear", _GREY, positions, faces, normals)])


def _strip(low: int, high: int, count: int) -> Array:
    """Triangles between two rings of equally many points."""
    here = np.arange(count)
    there = (here + 1) % count
    first = np.stack([low * count + here, low * count + there, high * count + there], axis=1)
    second = np.stack([low * count + here, high * count + there, high * count + here], axis=1)
    return np.concatenate([first, second])


SHAPES: dict[str, Callable[[], bytes]] = {
    "robot": lambda: write_parts(robot()),
    "robot-noisy": noisy_robot,
    "gear": gear,
    "knot-3k": lambda: knot(0.3),
    "knot-11k": lambda: knot(0.15),
    "knot-44k": lambda: knot(0.075),
}
