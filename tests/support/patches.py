"""Assets with UV charts that are known: bent patches side by side, in any shape in UV."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.support.glb_builder import GlbBuilder, grid


@dataclass(frozen=True)
class Patches:
    """A mesh of patches, each a chart of its own. Arrays are per corner (F x 3 x ...)."""

    corners: np.ndarray
    uv: np.ndarray  # V down, as in the file
    chart: np.ndarray  # F


def patches(seed: int, count: int) -> Patches:
    """Patches that are bent in space, and in UV turned, sheared, mirrored and laid over others."""
    random = np.random.default_rng(seed)
    corners, uv, chart = [], [], []
    for number in range(count):
        columns, rows = (int(n) for n in random.integers(1, 7, 2))
        flat, faces = grid(columns, rows)
        size = np.exp(random.uniform(-1, 1))
        solid = size * np.stack(
            [flat[:, 0], flat[:, 1], 0.3 * np.sin(flat[:, 0])], axis=1
        ) + np.array([20 * number, 0, 0])
        turn, stretch = random.uniform(0, 7), np.exp(random.uniform(-1, 1))
        turned = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        flip = random.choice([-1, 1])
        placed = (flat[:, :2] @ np.diag([1, flip * stretch]) + 0.2 * np.sin(flat[:, 1:2])) @ turned
        corners.append(solid[faces])
        uv.append((0.1 * placed + random.uniform(0, 1, 2))[faces])
        chart.append(np.full(len(faces), number))
    arrays = [np.concatenate(parts).astype("f") for parts in (corners, uv)]
    return Patches(*arrays, np.concatenate(chart))


def patch_builder(made: Patches) -> GlbBuilder:
    """The patches as one primitive."""
    builder = GlbBuilder()
    builder.node(
        mesh=builder.mesh(
            {
                "attributes": {
                    "POSITION": builder.positions(made.corners.reshape(-1, 3)),
                    "TEXCOORD_0": builder.accessor(made.uv.reshape(-1, 2)),
                }
            }
        )
    )
    return builder


def similarity(before: np.ndarray, after: np.ndarray) -> tuple[float, float]:
    """The best turn, scale and shift from points (n x 2) to others: its scale, its worst miss."""
    source, target = (points @ (1, 1j) for points in (before.astype(float), after.astype(float)))
    source, target = source - source.mean(), target - target.mean()
    factor = np.vdot(source, target) / np.vdot(source, source)
    return float(abs(factor)), float(np.abs(target - factor * source).max())
