"""How large charts are to each other before they are packed."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from partuv_worker.measure import areas_3d, signed_areas_2d

Array = NDArray[Any]

_THINNEST = 1e-12  # area over the square of the diagonal: a chart with less is a line
_LONGEST = 2.0  # edges in the atlas over those on the surface, where areas alone would make it more
_LEAST_EXTENT = 1e-4  # of the root of the surface: what single precision still draws as a chart


def scaled_charts(
    corner_uv: Array, corners: Array, chart: Array, repack_scale: Literal["uniform", "keep"]
) -> tuple[Array, Array]:
    """The UVs (F x 3 x 2) in units of the surface, each chart from 0; and charts without a size.

    corners: F x 3 x 3, in space. uniform: every chart has the area of its surface; it is larger if
    it were too small to draw, and smaller if it were drawn out, as one is whose UVs lie almost on
    a line. keep: one factor for all, so that the areas agree in sum. A chart has no size if it is a
    line or a point in UV though it has a surface.
    """
    count = int(chart.max()) + 1
    low, extent = _boxes(corner_uv, chart, count)
    flat = np.bincount(chart, np.abs(signed_areas_2d(corner_uv)), count)
    surface = np.bincount(chart, areas_3d(corners), count)
    is_line = flat <= _THINNEST * extent**2
    total = float(surface.sum())
    if repack_scale == "keep":
        factor = np.full(count, np.sqrt(total / max(float(flat.sum()), 1e-300)))
    else:
        by_area = np.sqrt(_ratio(surface, flat, otherwise=0.0))
        lengths = [np.bincount(chart, _perimeters(ends), count) for ends in (corners, corner_uv)]
        factor = np.minimum(by_area, _LONGEST * _ratio(*lengths, otherwise=0.0))
        least = np.full(count, _LEAST_EXTENT * np.sqrt(total))
        factor = np.maximum(factor, _ratio(least, extent, otherwise=1.0))
    scaled = (corner_uv - low[chart][:, None]) * factor[chart][:, None, None]
    return scaled, np.flatnonzero(is_line & (surface > 0))


def _ratio(above: Array, below: Array, *, otherwise: float) -> Array:
    result = np.full(len(above), otherwise)
    np.divide(above, below, out=result, where=below > 0)
    return result


def _perimeters(corners: Array) -> Array:
    """Of each triangle (F x 3 x d)."""
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=-1)
    perimeters: Array = sides.sum(axis=1)
    return perimeters


def _boxes(corner_uv: Array, chart: Array, count: int) -> tuple[Array, Array]:
    """The lower corner (C x 2) and the diagonal (C) of the box around every chart."""
    order = np.argsort(chart, kind="stable")
    starts = np.searchsorted(chart[order], np.arange(count))
    low = np.minimum.reduceat(corner_uv[order].min(axis=1), starts)
    high = np.maximum.reduceat(corner_uv[order].max(axis=1), starts)
    diagonal: Array = np.linalg.norm(high - low, axis=1)
    return low, diagonal
