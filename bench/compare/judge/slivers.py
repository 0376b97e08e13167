"""Charts that are too thin for a texture."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from partuv_worker.measure import areas_3d, side_ends, signed_areas_2d, welded
from scipy.sparse import coo_matrix, csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra

from bench.compare.judge.charts import Charts

Array = NDArray[Any]

RESOLUTION = 1024
THIN_TEXELS = 2.0
_GRID_TEXELS = 2.0**-10  # coordinates are rounded to it, which makes the union robust


def count_slivers(positions: Array, faces: Array, texture: Array, charts: Charts) -> int:
    """Charts that hold no circle 2 texels across at 1024, though the surface has room for one.

    texture: F x 3 x 2 in the unit square. Components are joined across edges that exactly two
    faces share which are wound alike: at others every unwrapping ends that is a manifold and turns
    no face over, as at a face that is wound against all its neighbours. A chart that is a whole
    component does not count, nor do those of a component that is itself as thin: its area over its
    longest shortest path along edges is then less than 2 texels at the mean scale of the atlas, or
    half of it where the component is a shell, whose area is that of its front and its back.
    """
    thin = _thin_charts(texture * RESOLUTION, charts)
    if not thin.size:
        return 0
    component = _components(charts)
    of_chart = np.zeros(charts.count, np.int64)
    of_chart[charts.of_face] = component
    is_whole = np.bincount(charts.of_face)[thin] == np.bincount(component)[of_chart[thin]]
    thin = thin[~is_whole]
    area_3d = areas_3d(positions[faces])
    area_2d = np.abs(signed_areas_2d(texture)).sum()
    texels_per_unit = RESOLUTION * np.sqrt(area_2d / max(float(area_3d.sum()), 1e-300))
    narrow = [
        number
        for number in np.unique(of_chart[thin])
        if texels_per_unit * _mean_width(positions, faces, charts, component == number)
        < THIN_TEXELS
    ]
    return int((~np.isin(of_chart[thin], narrow)).sum())


def _thin_charts(texels: Array, charts: Charts) -> Array:
    """Those that vanish if half the width is taken off around them."""
    radius = THIN_TEXELS / 2
    area = np.abs(signed_areas_2d(texels))
    of_chart = np.bincount(charts.of_face, area, charts.count)
    start, end = (texels[charts.border_face, (charts.border_side + step) % 3] for step in (0, 1))
    perimeter = np.bincount(
        charts.of_face[charts.border_face], np.linalg.norm(end - start, axis=1), charts.count
    )
    thin = of_chart < np.pi * radius**2
    # A region without holes has at most its perimeter times its inscribed circle's radius of area,
    # and with holes hardly more.
    unsure = ~thin & (of_chart < 2 * radius * perimeter)
    order = np.argsort(charts.of_face, kind="stable")
    bounds = np.searchsorted(charts.of_face[order], np.arange(charts.count + 1))
    for chart in np.flatnonzero(unsure):
        own = order[bounds[chart] : bounds[chart + 1]]
        triangles = shapely.polygons(texels[own[area[own] > 0]])
        shape = shapely.union_all(triangles, grid_size=_GRID_TEXELS)
        thin[chart] = shapely.is_empty(shapely.buffer(shape, -radius))
    found: Array = np.flatnonzero(thin)
    return found


def _components(charts: Charts) -> Array:
    """The component of each face."""
    count = len(charts.point)
    ends = side_ends(charts.point)
    edge = welded(np.sort(ends, axis=1))
    shared = np.flatnonzero(np.bincount(edge)[edge] == 2)
    sides = shared[np.argsort(edge[shared], kind="stable")].reshape(-1, 2)
    alike = ends[sides[:, 0], 0] != ends[sides[:, 1], 0]
    one, other = sides[alike].T // 3
    graph = coo_matrix((np.ones(len(one), bool), (one, other)), shape=(count, count))
    component: Array = connected_components(graph, directed=False)[1]
    return component


def _mean_width(positions: Array, faces: Array, charts: Charts, own: Array) -> float:
    """Area of a component over its longest shortest path, found by two sweeps over its edges.

    Of a shell half of that: its border is shorter than the path, while that of a sheet runs along
    both sides of it.
    """
    point = np.unique(charts.point[own], return_inverse=True)[1].reshape(-1, 3)
    corners = positions[faces[own]]
    lengths = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).ravel()
    edges, side, faces_at = np.unique(
        np.sort(side_ends(point), axis=1), axis=0, return_index=True, return_counts=True
    )
    border = float(lengths[side[faces_at == 1]].sum())
    graph = csr_matrix((lengths[side], edges.T), shape=(point.max() + 1,) * 2)
    far = int(dijkstra(graph, directed=False, indices=0).argmax())
    longest = float(dijkstra(graph, directed=False, indices=far).max())
    if longest <= 0:
        return 0.0
    return float(areas_3d(corners).sum()) / longest / (2 if border < longest else 1)
