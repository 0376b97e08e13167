"""A small robot, the sample that ships with the project: parts blended as generators make them.

`python -m partuv_worker.samples.robot OUT.glb` builds the file again.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from partuv_worker.samples.surface_nets import extract_surface
from partuv_worker.samples.write import Part, write_parts

Points = NDArray[np.float64]
Field = Callable[[Points], NDArray[np.float64]]  # n x 3 -> n signed distances, negative inside


def robot() -> list[Part]:
    """The parts of the robot; each is one closed surface."""
    return [
        Part(
            "Body",
            (0.93, 0.47, 0.20),
            *extract_surface(_body, (-1.55, -1.85, -0.65), (1.55, 1.0, 0.75), 0.075),
        ),
        Part(
            "Head",
            (0.95, 0.93, 0.88),
            *extract_surface(_head, (-1.05, 0.7, -0.6), (1.05, 2.8, 0.6), 0.07),
        ),
        Part(
            "Eyes",
            (0.10, 0.55, 0.75),
            *extract_surface(_eyes, (-0.6, 1.35, 0.3), (0.6, 1.85, 0.85), 0.05),
        ),
        Part(
            "Feet",
            (0.25, 0.28, 0.34),
            *extract_surface(_feet, (-0.95, -2.2, -0.5), (0.95, -1.15, 0.85), 0.07),
        ),
    ]


def _body(p: Points) -> NDArray[np.float64]:
    torso = _box(p, (0, 0.1, 0), (0.62, 0.72, 0.42), 0.28)
    arms = _capsule(_mirrored(p), (0.75, 0.5, 0.0), (1.12, -0.45, 0.3), 0.17)
    hands = _ball(_mirrored(p), (1.14, -0.6, 0.36), 0.25)
    legs = _capsule(_mirrored(p), (0.36, -0.75, 0.0), (0.42, -1.5, 0.0), 0.2)
    shape = _blend(_blend(torso, _blend(arms, hands, 0.08), 0.14), legs, 0.16)
    badge = _ball(p, (0, 0.3, 0.66), 0.26)
    return _blend(shape, badge, -0.08)


def _head(p: Points) -> NDArray[np.float64]:
    skull = _box(p, (0, 1.6, 0), (0.62, 0.42, 0.44), 0.3)
    ears = _capsule(_mirrored(p), (0.6, 1.6, 0.0), (0.76, 1.6, 0.0), 0.18)
    neck = _capsule(p, (0, 1.02, 0), (0, 1.3, 0), 0.22)
    mast = _capsule(p, (0, 1.95, 0), (0, 2.4, 0), 0.07)
    bulb = _ball(p, (0, 2.5, 0), 0.17)
    shape = _blend(_blend(skull, ears, 0.05), neck, 0.1)
    return _blend(shape, _blend(mast, bulb, 0.05), 0.1)


def _eyes(p: Points) -> NDArray[np.float64]:
    return _ball(_mirrored(p), (0.28, 1.62, 0.52), 0.17)


def _feet(p: Points) -> NDArray[np.float64]:
    sole = _box(_mirrored(p), (0.45, -1.82, 0.18), (0.32, 0.2, 0.5), 0.17)
    ankle = _capsule(_mirrored(p), (0.42, -1.75, 0.0), (0.42, -1.56, 0.0), 0.26)
    return _blend(sole, ankle, 0.12)


def _mirrored(p: Points) -> Points:
    return np.stack([np.abs(p[:, 0]), p[:, 1], p[:, 2]], axis=1)


def _ball(p: Points, center: Sequence[float], radius: float) -> NDArray[np.float64]:
    distance: NDArray[np.float64] = np.linalg.norm(p - center, axis=1) - radius
    return distance


def _box(
    p: Points, center: Sequence[float], half_size: Sequence[float], rounding: float
) -> NDArray[np.float64]:
    q = np.abs(p - center) - (np.array(half_size) - rounding)
    outside = np.linalg.norm(np.maximum(q, 0), axis=1)
    distance: NDArray[np.float64] = outside + np.minimum(q.max(axis=1), 0) - rounding
    return distance


def _capsule(
    p: Points, start: Sequence[float], end: Sequence[float], radius: float
) -> NDArray[np.float64]:
    axis = np.subtract(end, start)
    along = np.clip((p - start) @ axis / (axis @ axis), 0, 1)
    distance: NDArray[np.float64] = np.linalg.norm(p - start - along[:, None] * axis, axis=1)
    return distance - radius


def _blend(a: NDArray[np.float64], b: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """The union of two shapes with a fillet of this width; a negative width carves b out of a."""
    if width < 0:
        return -_blend(-a, b, -width)
    overlap = np.maximum(width - np.abs(a - b), 0) / width
    result: NDArray[np.float64] = np.minimum(a, b) - overlap**2 * width / 4
    return result


if __name__ == "__main__":
    Path(sys.argv[1]).write_bytes(write_parts(robot()))
