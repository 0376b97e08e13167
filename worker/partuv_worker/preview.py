"""The atlas as a picture: charts filled in the colour of their part, outlines drawn."""

from __future__ import annotations

import io
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from partuv_worker.measure import side_ends
from partuv_worker.parts.colors import Color, part_color

_SUPERSAMPLING = 3
_BACKGROUND: Color = (24, 27, 33)
_FRAME: Color = (58, 64, 75)
_WIRE_LIMIT_TEXELS = 5.0  # triangles smaller than this would only blur


def draw_atlas(
    corner_uv: NDArray[np.float32],
    chart: NDArray[np.int32],
    part: NDArray[np.int32],
    tile: NDArray[np.int32],
    size_texels: int = 1024,
) -> bytes:
    """A PNG of all tiles side by side.

    corner_uv: F x 3 x 2 in [0, 1], V up. chart, part, tile: F. O(F) time; the picture is drawn
    larger and scaled down, so that edges are smooth.
    """
    side = size_texels * _SUPERSAMPLING
    tiles = int(tile.max()) + 1 if len(tile) else 1
    picture = Image.new("RGB", (side * tiles, side), _BACKGROUND)
    brush = ImageDraw.Draw(picture)
    for number in range(tiles):
        frame = (number * side, 0, (number + 1) * side - 1, side - 1)
        brush.rectangle(frame, outline=_FRAME, width=_SUPERSAMPLING)
    points = corner_uv.astype(np.float64) * (1, -1) + (0, 1)
    points[..., 0] += tile[:, None]
    points *= side - 1
    region, part_of_region = regions(chart, part)
    colors = region_colors(part_of_region)
    _fill(brush, points, region, colors)
    mean_edge = float(np.linalg.norm(points[:, 0] - points[:, 1], axis=1).mean())
    if mean_edge > _WIRE_LIMIT_TEXELS * _SUPERSAMPLING:
        wires = [_mixed(color, _BACKGROUND, 0.18) for color in colors]
        _stroke(brush, points.reshape(-1, 3, 2), region, wires, 1)
    borders, owners = chart_borders(points, chart)
    outlines = [_mixed(color, (255, 255, 255), 0.55) for color in colors]
    _stroke(brush, borders, region[owners], outlines, _SUPERSAMPLING)
    small = picture.resize((size_texels * tiles, size_texels), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    small.save(stream, "PNG", optimize=True)
    return stream.getvalue()


def regions(
    chart: NDArray[np.int32], part: NDArray[np.int32]
) -> tuple[NDArray[np.int64], NDArray[np.int32]]:
    """The faces of one chart and one part: the region of each face, the part of each region."""
    pairs = chart.astype(np.int64) * (int(part.max(initial=0)) + 1) + part
    _, first, region = np.unique(pairs, return_index=True, return_inverse=True)
    return region, part[first]


def region_colors(part_of_region: NDArray[np.int32]) -> list[Color]:
    """A hue per part; the regions of a part differ a little in lightness."""
    rank: dict[int, int] = {}
    colors = []
    for part in part_of_region.tolist():
        rank[part] = rank.get(part, -1) + 1
        colors.append(part_color(part, rank[part]))
    return colors


def _mixed(color: Color, other: Color, share: float) -> Color:
    """A colour with a share of another one."""
    red, green, blue = (
        round(a * (1 - share) + b * share) for a, b in zip(color, other, strict=True)
    )
    return red, green, blue


def _fill(
    brush: ImageDraw.ImageDraw,
    points: NDArray[Any],
    region: NDArray[np.int64],
    colors: Sequence[Color],
) -> None:
    for triangle, key in zip(points.reshape(-1, 6).tolist(), region.tolist(), strict=True):
        brush.polygon(triangle, fill=colors[key])


def _stroke(
    brush: ImageDraw.ImageDraw,
    lines: NDArray[Any],
    owners: NDArray[np.int64],
    colors: Sequence[Color],
    width: int,
) -> None:
    """Draw polylines (n x points x 2), each in the colour of its owner."""
    flat = lines.reshape(len(lines), -1).tolist()
    for line, key in zip(flat, owners.tolist(), strict=True):
        brush.line(line, fill=colors[key], width=width)


def chart_borders(
    points: NDArray[Any], chart: NDArray[Any]
) -> tuple[NDArray[Any], NDArray[np.int64]]:
    """The edges (n x 2 x 2) that only one triangle of their chart has, and those triangles."""
    edges = side_ends(points)
    swap = (edges[:, 0, 0] > edges[:, 1, 0]) | (
        (edges[:, 0, 0] == edges[:, 1, 0]) & (edges[:, 0, 1] > edges[:, 1, 1])
    )
    directed = np.where(swap[:, None, None], edges[:, ::-1], edges)
    keys = np.concatenate([directed.reshape(-1, 4), np.repeat(chart, 3)[:, None]], axis=1)
    order = np.lexsort(keys.T)
    same = (keys[order][1:] == keys[order][:-1]).all(axis=1)
    single = np.ones(len(order), bool)
    single[1:] &= ~same
    single[:-1] &= ~same
    chosen = np.sort(order[single])
    return edges[chosen], chosen // 3
