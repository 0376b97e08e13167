"""The atlas as a picture: charts filled in the colour of their part, outlines drawn."""

from __future__ import annotations

import colorsys
import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

Color = tuple[int, int, int]

_SUPERSAMPLING = 3
_BACKGROUND: Color = (24, 27, 33)
_FRAME: Color = (58, 64, 75)
_GOLDEN_RATIO = 0.6180339887498949  # turns of the hue circle that never come close to each other
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
    colors = chart_colors(chart, part)
    _fill(brush, points, chart, colors)
    mean_edge = float(np.linalg.norm(points[:, 0] - points[:, 1], axis=1).mean())
    if mean_edge > _WIRE_LIMIT_TEXELS * _SUPERSAMPLING:
        wires = {key: _mixed(color, _BACKGROUND, 0.18) for key, color in colors.items()}
        _stroke(brush, points.reshape(-1, 3, 2), chart, wires, 1)
    borders, owners = chart_borders(points, chart)
    outlines = {key: _mixed(color, (255, 255, 255), 0.55) for key, color in colors.items()}
    _stroke(brush, borders, owners, outlines, _SUPERSAMPLING)
    small = picture.resize((size_texels * tiles, size_texels), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    small.save(stream, "PNG", optimize=True)
    return stream.getvalue()


def chart_colors(chart: NDArray[np.int32], part: NDArray[np.int32]) -> dict[int, Color]:
    """A hue per part; the charts of a part differ a little in lightness."""
    charts, first = np.unique(chart, return_index=True)
    order: dict[int, int] = {}
    colors = {}
    for key, owner in zip(charts.tolist(), part[first].tolist(), strict=True):
        rank = order[owner] = order.get(owner, -1) + 1
        hue = (0.58 + owner * _GOLDEN_RATIO) % 1.0
        lightness = 0.52 + 0.07 * (rank * 2 % 5 - 2) / 2
        rgb = colorsys.hls_to_rgb(hue, lightness, 0.5)
        colors[key] = (round(rgb[0] * 255), round(rgb[1] * 255), round(rgb[2] * 255))
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
    chart: NDArray[np.int32],
    colors: dict[int, Color],
) -> None:
    for triangle, key in zip(points.reshape(-1, 6).tolist(), chart.tolist(), strict=True):
        brush.polygon(triangle, fill=colors[key])


def _stroke(
    brush: ImageDraw.ImageDraw,
    lines: NDArray[Any],
    owners: NDArray[np.int32],
    colors: dict[int, Color],
    width: int,
) -> None:
    """Draw polylines (n x points x 2), each in the colour of its owner."""
    flat = lines.reshape(len(lines), -1).tolist()
    for line, key in zip(flat, owners.tolist(), strict=True):
        brush.line(line, fill=colors[key], width=width)


def chart_borders(
    points: NDArray[Any], chart: NDArray[np.int32]
) -> tuple[NDArray[Any], NDArray[np.int32]]:
    """The edges (n x 2 x 2) that only one triangle of their chart has, and their charts."""
    edges = np.stack([points, np.roll(points, -1, axis=1)], axis=2).reshape(-1, 2, 2)
    owners = np.repeat(chart, 3)
    swap = (edges[:, 0, 0] > edges[:, 1, 0]) | (
        (edges[:, 0, 0] == edges[:, 1, 0]) & (edges[:, 0, 1] > edges[:, 1, 1])
    )
    directed = np.where(swap[:, None, None], edges[:, ::-1], edges)
    keys = np.concatenate([directed.reshape(-1, 4), owners[:, None]], axis=1)
    order = np.lexsort(keys.T)
    same = (keys[order][1:] == keys[order][:-1]).all(axis=1)
    single = np.ones(len(order), bool)
    single[1:] &= ~same
    single[:-1] &= ~same
    chosen = np.sort(order[single])
    return edges[chosen], owners[chosen]
