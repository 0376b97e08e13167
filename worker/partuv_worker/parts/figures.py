"""What a report tells of every part."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_contract.report import ChartedPartFigures, PartFigures

from partuv_worker.glb.soup import TriangleSoup


def part_figures(soup: TriangleSoup, part: NDArray[Any]) -> list[PartFigures]:
    """One row per part, in the order of their numbers. part: F."""
    corners = soup.positions[soup.faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.bincount(part, np.linalg.norm(crosses, axis=1))
    shares = (areas / max(float(areas.sum()), 1e-300)).tolist()
    return [
        PartFigures(id=number, faces=faces, area_share=share)
        for number, (faces, share) in enumerate(zip(np.bincount(part), shares, strict=True))
    ]


def charted_part_figures(
    soup: TriangleSoup, part: NDArray[Any], chart: NDArray[Any]
) -> list[ChartedPartFigures]:
    """The same with the number of charts that have faces of a part. part, chart: F."""
    touched = np.unique(part.astype(np.int64) * len(part) + chart) // len(part)
    return [
        ChartedPartFigures(**row.model_dump(), charts=charts)
        for row, charts in zip(part_figures(soup, part), np.bincount(touched), strict=True)
    ]
