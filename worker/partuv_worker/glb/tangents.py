"""Tangents in the way of MikkTSpace (Mikkelsen 2008), for normal maps on a new UV set.

Triangles around a vertex are averaged by their angle in the vertex's tangent plane, separately for
each orientation of the mapping. The original also separates triangles that touch in the vertex
alone; a vertex with one position, normal and UV for both is too rare to follow it there.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from partuv_worker.measure import welded

Array = NDArray[Any]


def compute_tangents(positions: Array, normals: Array, uv: Array, faces: Array) -> Array:
    """Tangents (V x 4, float32) with the sign of the bitangent in w.

    positions, normals: V x 3; uv: V x 2, V up; faces: F x 3. O(V log V + F).
    """
    corners, corner_uv = positions[faces], uv[faces].astype(np.float64)
    sides, uv_sides = corners[:, 1:] - corners[:, :1], corner_uv[:, 1:] - corner_uv[:, :1]
    area = uv_sides[:, 0, 0] * uv_sides[:, 1, 1] - uv_sides[:, 0, 1] * uv_sides[:, 1, 0]
    sign = np.where(area < 0, -1.0, 1.0)
    along_u = uv_sides[:, 1, 1, None] * sides[:, 0] - uv_sides[:, 0, 1, None] * sides[:, 1]
    along_u = _unit(along_u) * sign[:, None]
    counts = (area != 0) & along_u.any(axis=1)

    shared = welded(np.concatenate([positions, normals, uv], axis=1))
    group = 2 * shared[faces] + (sign < 0)[:, None]
    total = np.zeros((2 * len(positions), 3))
    for corner in range(3):
        normal = normals[faces[:, corner]]
        tangent = _unit(_in_plane(along_u, normal))
        there, back = (
            _unit(_in_plane(corners[:, (corner + turn) % 3] - corners[:, corner], normal))
            for turn in (1, 2)
        )
        angle = np.arccos(np.clip(np.einsum("ij,ij->i", there, back), -1, 1))
        share = tangent * np.where(counts, angle, 0.0)[:, None]
        for axis in range(3):
            total[:, axis] += np.bincount(group[:, corner], share[:, axis], len(total))

    tangents = np.ones((len(positions), 4), np.float32)
    group_of_vertex = 2 * shared
    group_of_vertex[faces] = group
    tangents[faces, 3] = sign[:, None]
    found = _unit(total[group_of_vertex])
    missing = ~found.any(axis=1)
    found[missing] = _any_tangent(normals[missing])
    tangents[:, :3] = found
    return tangents


def _in_plane(vectors: Array, normals: Array) -> Array:
    """Vectors without their part along the normals."""
    across: Array = vectors - np.einsum("ij,ij->i", vectors, normals)[:, None] * normals
    return across


def _unit(vectors: Array) -> Array:
    """Vectors of length one; zero stays zero."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    unit: Array = np.divide(vectors, length, out=np.zeros_like(vectors), where=length > 0)
    return unit


def _any_tangent(normals: Array) -> Array:
    """Some direction across each normal."""
    smallest = np.abs(normals).argmin(axis=1)
    return _unit(_in_plane(np.eye(3)[smallest], normals))
