"""Keeping the charts of an asset: found, sized, packed by the engine and measured."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import partuv_engine
from numpy.typing import NDArray
from partuv_contract.errors import NoAreaError, OptionError, UnusableUvError
from partuv_contract.options import UnwrapOptions

from partuv_worker.engine_call import Atlas, ContextMaker, engine_options, for_each_mesh, translated
from partuv_worker.glb.soup import TriangleSoup
from partuv_worker.measure import areas_3d, measure_charts, signed_areas_2d, welded
from partuv_worker.parts.segment import cut_parts
from partuv_worker.repack.charts import find_charts
from partuv_worker.repack.scale import scaled_charts

Array = NDArray[Any]


def repack_soup(
    soup: TriangleSoup,
    corner_uv: NDArray[np.float64],
    features: NDArray[np.float32] | None,
    weight: NDArray[np.float64] | None,
    options: UnwrapOptions,
    deadline_s: float | None,
    make_context: ContextMaker,
) -> Atlas:
    """Pack the charts that UVs (F x 3 x 2) make of a soup; they are turned and scaled, not bent.

    features: F x d, for `parts: auto` or a number of them; without, the engine's own part tree.
    weight: texel density of each face (F) relative to others.
    """

    def call(mesh: TriangleSoup, own: slice, context: partuv_engine.Context) -> Atlas:
        own_features = None if features is None else features[own]
        own_weight = None if weight is None else weight[own]
        return _repack(mesh, corner_uv[own], own_features, own_weight, options, context)

    return for_each_mesh(soup, options.scope, deadline_s, make_context, call)


def folded_charts(corner_uv: NDArray[np.float64], chart: Array) -> int:
    """How many charts have faces of both windings, and so may lie over themselves."""
    area = signed_areas_2d(corner_uv)
    return len(np.intersect1d(chart[area > 0], chart[area < 0]))


def _repack(
    soup: TriangleSoup,
    corner_uv: NDArray[np.float64],
    features: NDArray[np.float32] | None,
    weight: NDArray[np.float64] | None,
    options: UnwrapOptions,
    context: partuv_engine.Context,
) -> Atlas:
    started = time.monotonic()
    corners = soup.positions[soup.faces]
    area_3d = areas_3d(corners)
    if not area_3d.any():
        raise NoAreaError("every triangle is degenerate: there is no surface")
    primitive = np.repeat(np.arange(len(soup.pieces)), [len(p.triangles) for p in soup.pieces])
    mesh = np.array([piece.primitive.mesh for piece in soup.pieces])[primitive]
    chart = find_charts(soup.positions, soup.faces, corner_uv, primitive, mesh)
    scaled, no_size = scaled_charts(corner_uv, corners, chart, options.repack_scale)
    if len(no_size):
        face = int(np.flatnonzero(chart == no_size[0])[0])
        _refuse(soup, int(primitive[face]), len(no_size))
    found = time.monotonic()

    part = primitive.astype(np.int32)
    if options.parts != "search":
        part = cut_parts(soup, features, options.parts, context)
    chart_part = _largest(part, chart, area_3d)
    chart_weight = _chart_weights(chart, weight, chart_part, int(part.max()), options)
    parted = time.monotonic()

    corner = np.dstack([np.broadcast_to(chart[:, None], soup.faces.shape), corner_uv])
    point = welded(corner.reshape(-1, 3)).astype(np.int32)
    points = np.empty((int(point.max()) + 1, 2))
    points[point] = scaled.reshape(-1, 2)
    try:
        packed = partuv_engine.pack(
            points,
            point.reshape(-1, 3),
            chart,
            engine_options(options),
            context,
            part=chart_part,
            weight=chart_weight,
        )
    except partuv_engine.EngineError as failure:
        raise translated(failure) from failure
    figures = measure_charts(soup.positions, soup.faces, packed.corner_uv, chart)
    return Atlas(
        corner_uv=packed.corner_uv,
        chart=chart,
        part=part,
        tile=packed.tile[chart],
        charts={
            "faces": np.bincount(chart),
            "part": chart_part,
            "tile": packed.tile,
            "area_3d": figures.area_3d,
            "area_distortion": figures.area_distortion,
            "angular": figures.angular,
        },
        tiles=packed.tiles,
        part_count=int(part.max()) + 1,
        efficiency=packed.efficiency,
        noise=None,
        seconds={
            "charts": found - started,
            "parts": parted - found,
            "packing": time.monotonic() - parted,
        },
    )


def _chart_weights(
    chart: Array,
    weight: NDArray[np.float64] | None,
    chart_part: NDArray[np.int32],
    last_part: int,
    options: UnwrapOptions,
) -> NDArray[np.float64]:
    """As in an unwrap: the largest weight of a chart's faces, times that of its part."""
    weights = np.ones(len(chart_part))
    if weight is not None:
        weights[:] = 0.0
        np.maximum.at(weights, chart, weight)
    for number, factor in options.weights().part.items():
        if number > last_part:
            raise OptionError(
                f"texel_weights: there is no part {number}, the last is {last_part}",
                pointer="/texel_weights",
            )
        weights[chart_part == number] *= factor
    return weights


def _refuse(soup: TriangleSoup, number: int, count: int) -> None:
    primitive = soup.pieces[number].primitive
    charts = "a chart" if count == 1 else f"{count} charts, the first"
    raise UnusableUvError(
        f"the UVs have {charts} without area, in primitive {primitive.number} of mesh "
        f"{primitive.mesh}: unwrap it, or choose others with `only`",
        pointer=primitive.pointer,
    )


def _largest(label: NDArray[np.int32], chart: Array, area_3d: Array) -> NDArray[np.int32]:
    """The label that most of the area of every chart has; the lowest of equals."""
    pair, place = np.unique(
        chart.astype(np.int64) * (int(label.max()) + 1) + label, return_inverse=True
    )
    owner, labels = np.divmod(pair, int(label.max()) + 1)
    area = np.bincount(place, area_3d)
    order = np.lexsort((labels, -area, owner))
    firsts = np.searchsorted(owner[order], np.arange(int(chart.max()) + 1))
    largest: NDArray[np.int32] = labels[order][firsts].astype(np.int32)
    return largest
