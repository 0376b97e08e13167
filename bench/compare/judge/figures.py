"""All figures of an atlas, whichever tool made it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_worker.measure import areas_3d, have_area, measure_atlas, signed_areas_2d

from bench.compare.judge.charts import Charts, find_charts
from bench.compare.judge.gutter import least_gutter_uv
from bench.compare.judge.overlaps import find_overlaps
from bench.compare.judge.seams import seam_roughness
from bench.compare.judge.slivers import count_slivers

Array = NDArray[Any]

_ROUNDING_UV = 2.0**-23  # a triangle that is no higher has no winding that single precision knows
_OUTSIDE_UV = 1e-6


@dataclass(frozen=True)
class Figures:
    """What one atlas is worth; `docs/benchmarks.md` says what each figure means."""

    charts: int
    single_face_charts: int
    area_distortion_worst: float
    area_distortion_mean: float
    angular_mean: float
    angular_all_frames: float
    seam_length: float
    flipped_faces: int
    overlapping_pairs: int
    overlaps_complete: bool
    gutter_texels: float | None  # on a texture of 1024 texels
    efficiency: float
    # None in records from before they were measured; the roughness also without seams.
    slivers: int | None = None
    seam_roughness: float | None = None


def judge(
    positions: Array, faces: Array, corner_uv: Array, *, overlap_limit_s: float = 60.0
) -> Figures:
    """Judge an atlas. positions: V x 3; faces: F x 3; corner_uv: F x 3 x 2, finite, V up."""
    uv = corner_uv.astype(np.float64)
    charts = find_charts(positions, faces, uv)
    measured = measure_atlas(positions, faces, uv, charts.of_face)
    corners = positions[faces]
    solid = have_area(corners, areas_3d(corners))
    whole = _normalised(uv)
    area = signed_areas_2d(whole)
    longest = np.linalg.norm(np.roll(whole, -1, axis=1) - whole, axis=2).max(axis=1)
    open_faces = 2 * np.abs(area) > _ROUNDING_UV * longest
    inside = uv.min() >= -_OUTSIDE_UV and uv.max() <= 1 + _OUTSIDE_UV
    texture = uv if inside else whole
    overlaps = find_overlaps(texture, np.flatnonzero(open_faces), overlap_limit_s)
    meeting = charts.of_face[overlaps.pairs]
    return Figures(
        charts=charts.count,
        single_face_charts=int((np.bincount(charts.of_face) == 1).sum()),
        area_distortion_worst=measured.area_distortion_worst,
        area_distortion_mean=measured.area_distortion_mean,
        angular_mean=measured.angular_mean,
        angular_all_frames=measured.angular_all_frames,
        seam_length=measured.seam_length,
        flipped_faces=_flipped(area, charts, open_faces & solid),
        overlapping_pairs=len(overlaps.pairs),
        overlaps_complete=overlaps.complete,
        gutter_texels=_gutter_texels(
            texture, charts, overlapping=bool((meeting[:, 0] != meeting[:, 1]).any())
        ),
        efficiency=float(np.abs(area).sum()),
        slivers=count_slivers(positions, faces, texture, charts),
        seam_roughness=seam_roughness(positions, faces, charts),
    )


def _normalised(uv: Array) -> Array:
    """Moved and scaled equally in U and V so that the longer side of their box is 1."""
    low, high = uv.min(axis=(0, 1)), uv.max(axis=(0, 1))
    normalised: Array = (uv - low) / (float((high - low).max()) or 1.0)
    return normalised


def _flipped(area: Array, charts: Charts, counted: Array) -> int:
    """Faces wound against the greater part, by area, of their chart."""
    facing = np.where(np.bincount(charts.of_face, area) < 0, -1.0, 1.0)
    return int((counted & (area * facing[charts.of_face] < 0)).sum())


def _gutter_texels(texture: Array, charts: Charts, *, overlapping: bool) -> float | None:
    if overlapping:
        return 0.0
    ends = [texture[charts.border_face, (charts.border_side + step) % 3] for step in (0, 1)]
    gutter = least_gutter_uv(np.stack(ends, axis=1), charts.of_face[charts.border_face])
    return None if gutter is None else gutter * 1024
