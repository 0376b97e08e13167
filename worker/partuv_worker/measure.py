"""Figures of an atlas, measured on the mesh and its UVs alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]

_CLIP = 10.0  # largest area distortion of a face
_LEAST_AREA = 1e-14  # of the squared diagonal: smaller faces are at float32 rounding


@dataclass(frozen=True)
class ChartFigures:
    """The same for every chart: arrays with an element each."""

    area_3d: Array
    area_distortion: Array
    angular: Array


@dataclass(frozen=True)
class AtlasFigures:
    """Distortion as in PartUV (Wang et al. 2025, Evaluation Metrics), faces counted equally."""

    area_distortion_mean: float
    area_distortion_worst: float  # of the means of the charts
    angular_mean: float
    angular_all_frames: float  # the mean of that score over all rotations of the charts
    seam_length: float  # over the square root of the surface's area


def measure_atlas(positions: Array, faces: Array, corner_uv: Array, chart: Array) -> AtlasFigures:
    """Measure an atlas. positions: V x 3; faces: F x 3; corner_uv: F x 3 x 2; chart: F."""
    valid, area_3d, distortion, angular, all_frames = _faces(positions, faces, corner_uv, chart)
    if not valid.any():
        return AtlasFigures(1.0, 1.0, 1.0, 1.0, 0.0)
    count = np.bincount(chart[valid])
    sums = np.bincount(chart[valid], distortion)[count > 0]
    length = _seam_length(positions, faces, corner_uv)
    return AtlasFigures(
        area_distortion_mean=float(distortion.mean()),
        area_distortion_worst=float((sums / count[count > 0]).max()),
        angular_mean=float(angular.mean()),
        angular_all_frames=float(all_frames.mean()),
        seam_length=length / float(np.sqrt(area_3d.sum())),
    )


def measure_charts(positions: Array, faces: Array, corner_uv: Array, chart: Array) -> ChartFigures:
    """Measure every chart; one without a face of any area has no distortion."""
    valid, area_3d, distortion, angular, _ = _faces(positions, faces, corner_uv, chart)
    count = int(chart.max()) + 1
    measured = np.bincount(chart[valid], minlength=count)

    def mean(values: Array) -> Array:
        sums = np.bincount(chart[valid], values, count)
        return np.divide(sums, measured, out=np.ones(count), where=measured > 0)

    return ChartFigures(np.bincount(chart, area_3d, count), mean(distortion), mean(angular))


def areas_3d(corners: Array) -> Array:
    """Area of every face (F x 3 x 3)."""
    sides = corners[:, 1:] - corners[:, :1]
    areas: Array = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1) / 2
    return areas


def signed_areas_2d(corner_uv: Array) -> Array:
    """Area of every face in UV, negative for clockwise ones."""
    sides = corner_uv[:, 1:].astype(np.float64) - corner_uv[:, :1]
    areas: Array = (sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]) / 2
    return areas


def have_area(corners: Array, areas: Array) -> Array:
    """Faces (F x 3 x 3) with these areas that single precision can tell from lines."""
    extent = np.ptp(corners.reshape(-1, 3), axis=0)
    large: Array = areas > _LEAST_AREA * float(extent @ extent)
    return large


def _faces(
    positions: Array, faces: Array, corner_uv: Array, chart: Array
) -> tuple[Array, Array, Array, Array, Array]:
    """Which faces are large enough to be judged, the area of all, and those faces' distortions."""
    corners = positions[faces]
    sides = corners[:, 1:] - corners[:, :1]
    uv_sides = corner_uv[:, 1:].astype(np.float64) - corner_uv[:, :1]
    area_2d, area_3d = signed_areas_2d(corner_uv), areas_3d(corners)
    valid = have_area(corners, area_3d)
    return (
        valid,
        area_3d,
        _area_distortion(np.abs(area_2d[valid]), area_3d[valid], chart[valid]),
        *_angular(sides[valid], uv_sides[valid], area_2d[valid]),
    )


def _area_distortion(area_2d: Array, area_3d: Array, chart: Array) -> Array:
    """max(s, 1/s) per face, s its scale of area over that of its chart (Eq. 1)."""
    scale = np.bincount(chart, area_2d) / np.maximum(np.bincount(chart, area_3d), 1e-300)
    with np.errstate(divide="ignore", invalid="ignore"):
        stretch = area_2d / area_3d / scale[chart]
        distortion = np.maximum(stretch, 1 / stretch)
    clipped: Array = np.minimum(np.nan_to_num(distortion, nan=_CLIP, posinf=_CLIP), _CLIP)
    return clipped


def _angular(sides: Array, uv_sides: Array, determinant: Array) -> tuple[Array, Array]:
    """1 - |cos| of the angle between the images of the U and V axes (Srinivasan et al. 2024).

    And the mean of that over all directions of the axes, which sees a stretch along them as well:
    1 - (2 / pi) asin((s1^2 - s2^2) / (s1^2 + s2^2)), s1 >= s2 the singular values of the map.
    """
    tangent = uv_sides[:, 1, 1, None] * sides[:, 0] - uv_sides[:, 0, 1, None] * sides[:, 1]
    bitangent = uv_sides[:, 0, 0, None] * sides[:, 1] - uv_sides[:, 1, 0, None] * sides[:, 0]
    e, f, g = (
        np.einsum("ij,ij->i", one, other)
        for one, other in ((tangent, tangent), (tangent, bitangent), (bitangent, bitangent))
    )
    defined = (e > 0) & (g > 0) & (determinant != 0)
    cosine = np.divide(np.abs(f), np.sqrt(e * g), out=np.ones_like(f), where=defined)
    spread = np.divide(np.hypot(e - g, 2 * f), e + g, out=np.ones_like(f), where=defined)
    return 1 - np.minimum(cosine, 1), 1 - np.arcsin(np.minimum(spread, 1)) * 2 / np.pi


def _seam_length(positions: Array, faces: Array, uv: Array) -> float:
    """Length of the edges that bound a chart though several faces meet there; each edge once."""
    start, end = side_ends(welded(positions)[faces]).T
    backward = start > end
    edge = np.minimum(start, end) * len(positions) + np.maximum(start, end)
    uv_ends = side_ends(uv)
    uv_ends = np.where(backward[:, None, None], uv_ends[:, ::-1], uv_ends)
    order = np.argsort(edge)  # the sides of each edge in a row
    first = np.flatnonzero(np.diff(edge[order], prepend=-1))
    count = np.diff(first, append=len(order))
    # Nearly all edges have two sides, so those are compared without further ado.
    is_seam = count == 2
    one, other = order[first[is_seam]], order[first[is_seam] + 1]
    is_seam[is_seam] = (uv_ends[one] != uv_ends[other]).any(axis=(1, 2))
    crowded = np.repeat(count > 2, count)
    if crowded.any():
        number = np.repeat(np.arange(len(count)), count)[crowded]
        alike = welded(np.column_stack([number, uv_ends[order[crowded]].reshape(-1, 4)]))
        is_seam[number[np.bincount(alike)[alike] == 1]] = True
    side = order[first[is_seam]]
    start, end = faces.ravel()[side], np.roll(faces, -1, axis=1).ravel()[side]
    return float(np.linalg.norm(positions[end] - positions[start], axis=1).sum())


def side_ends(corners: Array) -> Array:
    """What corners have (F x 3 or F x 3 x N) at both ends of each side, 3 F x 2 (x N).

    Side k of face f runs from its corner k to the next one and is in row 3 f + k.
    """
    ends = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2)
    return ends.reshape(-1, 2, *corners.shape[2:])


def welded(rows: Array) -> Array:
    """A number for each row, equal for exactly equal rows, ascending with the rows.

    Pairs of numbers that this made, or other integers below 2^31, take half the time.
    """
    if rows.dtype == np.int64 and rows.shape[1] == 2 and len(rows):
        first, second = rows.T
        keys = first * (np.ptp(second) + 1) + (second - second.min())
        return np.unique(keys, return_inverse=True)[1]
    order = np.lexsort(rows.T[::-1])
    ordered = rows[order]
    number = np.empty(len(rows), np.int64)
    number[order] = np.cumsum(
        np.concatenate([[0], (ordered[1:] != ordered[:-1]).any(axis=1).astype(np.int64)])
    )
    return number
