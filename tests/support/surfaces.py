"""Shapes for tests of the engine's mesh stages, and what stays the same on any triangulation."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components


def grid_sheet(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """A flat rectangle of columns x rows quads in the plane z = 0."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    positions = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    corner = (np.arange(columns)[:, None] * (rows + 1) + np.arange(rows)).ravel()
    a, b, c, d = corner, corner + rows + 1, corner + rows + 2, corner + 1
    return positions, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def box(cells: int) -> tuple[np.ndarray, np.ndarray]:
    """A closed cube [0, cells]^3 with a grid of cells x cells quads on each side."""
    flat, faces = grid_sheet(cells, cells)
    u, v, zero = flat.T
    full = zero + cells
    sides = [(u, v, full), (v, u, zero), (full, u, v), (zero, v, u), (v, full, u), (u, zero, v)]
    positions = np.concatenate([np.stack(side, axis=1) for side in sides])
    return positions, np.concatenate([faces + i * len(flat) for i in range(len(sides))])


def torus(around: int, across: int, radius: float = 3.0) -> tuple[np.ndarray, np.ndarray]:
    """A closed torus whose tube has radius 1."""
    sheet, faces = grid_sheet(around, across)
    s, t = 2 * np.pi * sheet[:, 0] / around, 2 * np.pi * sheet[:, 1] / across
    ring = radius + np.cos(t)
    positions = np.stack([ring * np.cos(s), ring * np.sin(s), np.sin(t)], axis=1)
    number = (sheet[:, 0] % around * across + sheet[:, 1] % across).astype(int)
    first = np.unique(number, return_index=True)[1]
    return positions[first], number[faces]


def sphere(subdivisions: int) -> tuple[np.ndarray, np.ndarray]:
    """A unit sphere of 20 * 4 ** subdivisions triangles."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=subdivisions)
    return np.asarray(ball.vertices), np.asarray(ball.faces)


def with_noise(positions: np.ndarray, amplitude: float, seed: int = 1) -> np.ndarray:
    return positions + amplitude * np.random.default_rng(seed).normal(size=positions.shape)


def face_crosses(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Normals of twice the faces' areas."""
    a, b, c = np.moveaxis(positions[faces], 1, 0)
    return np.cross(b - a, c - a)


def face_areas(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    return 0.5 * np.linalg.norm(face_crosses(positions, faces), axis=1)


def region_topology(opposite: np.ndarray, label: np.ndarray) -> dict[int, tuple[int, int, int]]:
    """(parts, Euler characteristic, boundary loops) of each label's faces.

    Faces of a region hang together by their sides alone; a vertex at which it only touches itself
    counts once for each fan of faces.
    """
    count = len(label)
    inside = (opposite >= 0) & (label[opposite // 3] == label[:, None])
    half = np.arange(3 * count).reshape(-1, 3)
    across = opposite[inside]
    # A half-edge and the one after its opposite leave the same vertex.
    fan = _components(3 * count, half[inside], across - across % 3 + (across + 1) % 3)
    part = _components(count, half[inside] // 3, across // 3)
    start, side = np.nonzero(~inside)
    loop = _components(fan.max() + 1, fan[3 * start + side], fan[3 * start + (side + 1) % 3])
    result = {}
    for value in np.unique(label):
        faces = np.nonzero(label == value)[0]
        rim = start[label[start] == value]
        sides = side[label[start] == value]
        edges = inside[faces].sum() // 2 + len(rim)
        vertices = len(np.unique(fan[half[faces]]))
        result[int(value)] = (
            len(np.unique(part[faces])),
            vertices - edges + len(faces),
            len(np.unique(loop[fan[3 * rim + sides]])),
        )
    return result


def _components(count: int, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    graph = coo_array((np.ones(len(a)), (a, b)), (count, count))
    return connected_components(graph, directed=False)[1]
