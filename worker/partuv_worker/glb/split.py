"""Which vertices a UV seam splits."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Split:
    """Vertices after the split: the old ones keep their numbers, copies follow after them."""

    corners: NDArray[np.int64]  # C: the vertex of each corner
    sources: NDArray[np.int64]  # E: the old vertex that each copy was made of
    vertex_uv: NDArray[np.float32]  # (V + E) x 2; zero where no corner uses a vertex


def split_vertices(
    corners: NDArray[np.int64], corner_uv: NDArray[np.float32], vertex_count: int
) -> Split:
    """Give each vertex one UV, with as few copies as there are further UVs at it.

    corners: C, a vertex number per corner. corner_uv: C x 2. O(C), and O(S log S) in the number S
    of corners on seams. The first corner of a vertex, in the order of the corners, decides which UV
    stays with the old number, so the result is deterministic.
    """
    uv = np.ascontiguousarray(corner_uv, np.float32) + np.float32(0)  # no -0: equal means same bits
    key = uv.view(np.uint64).ravel()
    first_corner = np.full(vertex_count, -1, np.int64)
    first_corner[corners[::-1]] = np.arange(len(corners) - 1, -1, -1)  # the last one written stays
    on_seam = np.flatnonzero(key != key[first_corner[corners]])

    vertices, keys = corners[on_seam], key[on_seam]
    order = np.lexsort((keys, vertices))
    vertices, keys = vertices[order], keys[order]
    starts = np.ones(len(order), bool)
    starts[1:] = (vertices[1:] != vertices[:-1]) | (keys[1:] != keys[:-1])

    split_corners = corners.copy()
    split_corners[on_seam[order]] = vertex_count + np.cumsum(starts) - 1
    sources = vertices[starts]
    vertex_uv = np.zeros((vertex_count + len(sources), 2), np.float32)
    vertex_uv[split_corners] = uv
    return Split(split_corners, sources, vertex_uv)
