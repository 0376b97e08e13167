"""How straight the seams run."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_worker.measure import side_ends, welded
from scipy.sparse import csr_matrix, identity
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from bench.compare.judge.charts import Charts

Array = NDArray[Any]

_HALVED_WAVE_EDGES = 8
_STIFFNESS = (2 - 2 * np.cos(2 * np.pi / _HALVED_WAVE_EDGES)) ** -2


def seam_roughness(positions: Array, faces: Array, charts: Charts) -> float | None:
    """Length of the seams over the length of the same seams smoothed; none without seams.

    Seams are smoothed between their junctions and ends, which stay. Smooth points minimise their
    squared distance to the given ones and, weighted, their second differences (Whittaker 1923;
    Eilers 2003): straight seams stay as they are whatever their edges' lengths, a wave of 8 edges
    is halved, one of 16 keeps 94 %, and a zigzag from edge to edge 2 %. A loop without junctions is
    scaled to its former mean distance from its centre, since it would shrink.
    """
    corner, ends = _seam_edges(charts)
    if not len(ends):
        return None
    points = positions[faces.ravel()[corner]]
    smooth = _smoothed(points, ends)
    length, smooth_length = _length(points, ends), _length(smooth, ends)
    return length / smooth_length if smooth_length > 0 else None


def _seam_edges(charts: Charts) -> tuple[Array, Array]:
    """Edges between faces across which UVs jump, each once.

    Gives a corner of each point on them, and their ends (E x 2) as numbers of those points.
    """
    ends = side_ends(charts.point)
    edge = welded(np.sort(ends, axis=1))
    at_border = np.unique(edge[3 * charts.border_face + charts.border_side])
    _, side, uses = np.unique(edge, return_index=True, return_counts=True)
    seam = side[at_border[uses[at_border] > 1]]
    seam = seam[ends[seam, 0] != ends[seam, 1]]
    seam_corners = np.stack([seam, seam - seam % 3 + (seam + 1) % 3], axis=1)
    _, first, number = np.unique(ends[seam], return_index=True, return_inverse=True)
    return seam_corners.ravel()[first], number.reshape(-1, 2)


def _smoothed(points: Array, ends: Array) -> Array:
    """The points of a graph of edges; those with two neighbours move."""
    count = len(points)
    both = np.concatenate([ends, ends[:, ::-1]])
    inner = np.bincount(both[:, 0], minlength=count) == 2
    links = csr_matrix((np.ones(len(both)), both.T), shape=(count, count))
    bend = (links - 2 * identity(count, format="csr"))[inner]
    system = identity(int(inner.sum()), format="csr")
    system += _STIFFNESS * bend[:, inner].T @ bend[:, inner]
    pull = _STIFFNESS * bend[:, inner].T @ (bend[:, ~inner] @ points[~inner])
    smooth = points.astype(np.float64)
    if inner.any():
        smooth[inner] = splu(system.tocsc()).solve(smooth[inner] - pull)
    _, line = connected_components(links[inner][:, inner], directed=False)
    held = np.bincount(line, links[inner][:, ~inner].sum(axis=1).A1) > 0
    is_loop = ~held[line]
    of_loop = np.flatnonzero(inner)[is_loop]
    smooth[of_loop] = _spread(smooth[of_loop], points[of_loop], line[is_loop])
    return smooth


def _spread(points: Array, model: Array, group: Array) -> Array:
    """Groups of points, each scaled about its centre to the spread of the model's group."""
    count = np.maximum(np.bincount(group), 1)

    def centred(values: Array) -> tuple[Array, Array]:
        centre = np.stack([np.bincount(group, column) / count for column in values.T], axis=1)
        offset = values - centre[group]
        return offset, np.bincount(group, (offset**2).sum(axis=1))

    offset, squares = centred(points)
    model_squares = centred(model)[1]
    scale = np.sqrt(np.divide(model_squares, squares, out=np.ones(len(count)), where=squares > 0))
    moved: Array = points - offset + scale[group, None] * offset
    return moved


def _length(points: Array, ends: Array) -> float:
    return float(np.linalg.norm(points[ends[:, 1]] - points[ends[:, 0]], axis=1).sum())
