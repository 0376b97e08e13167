"""The atlas as vectors: paths in the colours of the parts."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import Any

import numpy as np
from numpy.typing import NDArray

from partuv_worker.preview import chart_borders, region_colors, regions

_BACKGROUND = "#181b21"
_FRAME = "#3a404b"

Point = tuple[float, float]


def draw_atlas_svg(
    corner_uv: NDArray[np.float32],
    chart: NDArray[np.int32],
    part: NDArray[np.int32],
    tile: NDArray[np.int32],
    size_texels: int = 1024,
) -> bytes:
    """All tiles side by side. corner_uv: F x 3 x 2 in [0, 1], V up. chart, part, tile: F.

    Each path carries its chart and part as data attributes; a chart with faces of several parts has
    a path for each, and its outline. O(F log F) time.
    """
    points = corner_uv.astype(np.float64) * (1, -1) + (0, 1)
    points[..., 0] += tile[:, None]
    points = np.round(points * size_texels, 3)
    tiles = int(tile.max()) + 1 if len(tile) else 1
    region, part_of_region = regions(chart, part)
    colors = region_colors(part_of_region)
    chart_of_region = dict(zip(region.tolist(), chart.tolist(), strict=True))
    shared = Counter(chart_of_region.values())
    size = f"{tiles * size_texels} {size_texels}"
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {size}">']
    lines += [
        f'<rect x="{number * size_texels}" width="{size_texels}" height="{size_texels}" '
        f'fill="{_BACKGROUND}" stroke="{_FRAME}"/>'
        for number in range(tiles)
    ]
    outline = 'stroke="#fff" stroke-width="0.5"'
    for key, path in sorted(_outlines(points, region).items()):
        color = "#{:02x}{:02x}{:02x}".format(*colors[key])
        owner = chart_of_region[key]
        lines.append(
            f'<path data-chart="{owner}" data-part="{part_of_region[key]}" fill="{color}" '
            f'fill-rule="evenodd" {outline if shared[owner] == 1 else ""} d="{path}"/>'
        )
    crossed = np.array([shared[owner] > 1 for owner in chart.tolist()])
    for owner, path in sorted(_outlines(points[crossed], chart[crossed]).items()):
        lines.append(f'<path data-chart="{owner}" fill="none" {outline} d="{path}"/>')
    return "\n".join([*lines, "</svg>\n"]).encode()


def _outlines(points: NDArray[Any], group: NDArray[Any]) -> dict[int, str]:
    """The boundary loops of each group of faces as path data."""
    borders, faces = chart_borders(points, group)
    edges: dict[int, dict[Point, list[Point]]] = {}
    for ((x0, y0), (x1, y1)), owner in zip(borders.tolist(), group[faces].tolist(), strict=True):
        edges.setdefault(owner, defaultdict(list))[x0, y0].append((x1, y1))
    return {owner: _loops(of_group) for owner, of_group in edges.items()}


def _loops(edges: dict[Point, list[Point]]) -> str:
    """Directed edges walked end to end; where several leave a point, in their order."""
    path = []
    for start in list(edges):
        while edges.get(start):
            loop, here = [start], start
            while edges.get(here):
                here = edges[here].pop(0)
                loop.append(here)
            corners = "L".join(f"{x:g},{y:g}" for x, y in loop[:-1])
            path.append(f"M{corners}Z")
    return "".join(path)
