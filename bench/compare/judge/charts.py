"""The charts of an atlas, found from positions and UVs alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_worker.measure import side_ends, welded
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

Array = NDArray[Any]


@dataclass(frozen=True)
class Charts:
    """Faces joined across edges of which both ends have the same UVs on either side."""

    of_face: Array  # F
    count: int
    point: Array  # F x 3: the position of each corner, by a number
    border_face: Array  # B: the face of each chart border edge
    border_side: Array  # B: side s of a face runs from its corner s to corner (s + 1) % 3


def find_charts(positions: Array, faces: Array, corner_uv: Array) -> Charts:
    """Find charts. positions: V x 3; faces: F x 3; corner_uv: F x 3 x 2, finite."""
    point = welded(positions)[faces]
    place = welded(corner_uv.reshape(-1, 2)).reshape(-1, 1)
    corner = welded(np.hstack([point.reshape(-1, 1), place])).reshape(-1, 3)
    sides = side_ends(corner)
    sides.sort(axis=1)
    proper = np.flatnonzero(sides[:, 0] != sides[:, 1])
    edge = welded(sides[proper])
    uses = np.bincount(edge)
    by_edge = proper[np.argsort(edge, kind="stable")]
    same_edge = np.repeat(np.arange(len(uses)), uses)
    joined = np.flatnonzero(same_edge[1:] == same_edge[:-1])
    links = by_edge[joined] // 3, by_edge[joined + 1] // 3
    graph = coo_matrix((np.ones(len(joined), bool), links), shape=(len(faces), len(faces)))
    count, of_face = connected_components(graph, directed=False)
    borders = np.sort(proper[uses[edge] == 1])
    return Charts(of_face.astype(np.int64), int(count), point, borders // 3, borders % 3)
