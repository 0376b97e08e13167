"""Meshes for tests of the service: a quick one, and one that keeps the engine busy."""

from __future__ import annotations

import numpy as np

from tests.support.glb_builder import GlbBuilder


def bumpy_ball(rings: int, seed: int = 0, bumps: float = 0.25) -> bytes:
    """A closed ball of about 4 * rings^2 triangles with random bumps; each seed is another one."""
    random = np.random.default_rng(seed)
    columns = 2 * rings
    polar, turn = np.meshgrid(
        np.linspace(0, np.pi, rings + 1)[1:-1],
        np.linspace(0, 2 * np.pi, columns, endpoint=False),
        indexing="ij",
    )
    points = np.stack(
        [np.sin(polar) * np.cos(turn), np.sin(polar) * np.sin(turn), np.cos(polar)], axis=-1
    ).reshape(-1, 3)
    points = np.concatenate([points, [[0, 0, 1], [0, 0, -1]]])
    waves = random.normal(size=(6, 3)) * 4
    points *= 1 + bumps * np.sin(points @ waves.T + random.uniform(0, 6, 6)).mean(axis=1)[:, None]
    return to_glb(points, _ball_faces(rings, columns))


def to_glb(points: np.ndarray, faces: np.ndarray) -> bytes:
    """One mesh, one node."""
    builder = GlbBuilder()
    primitive = {
        "attributes": {"POSITION": builder.positions(points.astype("f"))},
        "indices": builder.accessor(faces.ravel().astype("I")),
    }
    builder.node(mesh=builder.mesh(primitive))
    return builder.build()


def quick(seed: int = 0) -> bytes:
    """A hundred triangles: done in a fraction of a second."""
    return bumpy_ball(6, seed)


def slow(seed: int = 0) -> bytes:
    """Keeps the engine busy for ten seconds of processor time, unless there is a deadline."""
    return bumpy_ball(120, seed, bumps=12.0)


def large(seed: int = 0) -> bytes:
    """A hundred thousand triangles."""
    return bumpy_ball(170, seed)


def _ball_faces(rings: int, columns: int) -> np.ndarray:
    rows = rings - 1
    here = (np.arange(rows - 1)[:, None] * columns + np.arange(columns)).ravel()
    row, column = here // columns, here % columns
    right = row * columns + (column + 1) % columns
    below, below_right = here + columns, right + columns
    body = np.concatenate(
        [np.stack([here, below, right], 1), np.stack([right, below, below_right], 1)]
    )
    top, bottom = rows * columns, rows * columns + 1
    ring = np.arange(columns)
    next_one = (ring + 1) % columns
    last = (rows - 1) * columns
    caps = np.concatenate(
        [
            np.stack([np.full(columns, top), ring, next_one], 1),
            np.stack([last + ring, np.full(columns, bottom), last + next_one], 1),
        ]
    )
    return np.concatenate([body, caps])
