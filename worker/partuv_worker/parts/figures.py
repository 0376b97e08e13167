"""What a report tells of every part."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_contract.report import PartFigures

from partuv_worker.glb.soup import TriangleSoup


def part_figures(soup: TriangleSoup, part: NDArray[Any], chart: NDArray[Any]) -> list[PartFigures]:
    """One row per part, in the order of their numbers. part, chart: F."""
    corners = soup.positions[soup.faces]
    crosses = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.bincount(part, np.linalg.norm(crosses, axis=1))
    touched = np.unique(part.astype(np.int64) * len(part) + chart) // len(part)
    rows = zip(
        np.bincount(part).tolist(),
        (areas / max(float(areas.sum()), 1e-300)).tolist(),
        np.bincount(touched).tolist(),
        strict=True,
    )
    return [
        PartFigures(id=number, faces=faces, area_share=share, charts=charts)
        for number, (faces, share, charts) in enumerate(rows)
    ]
