"""The room between charts."""

from __future__ import annotations

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from bench.compare.judge.pairs import NearPairs

Array = NDArray[Any]

_FIRST_REACH_UV = 2 / 1024
_LAST_REACH_UV = 0.5


def least_gutter_uv(segments: Array, chart: Array) -> float | None:
    """Smallest distance between the borders of two charts; none with one, or beyond 0.5.

    segments: B x 2 x 2 border edges in UV; chart: B.
    """
    if len(np.unique(chart)) < 2:
        return None
    lines = shapely.linestrings(segments)
    reach = _FIRST_REACH_UV
    while reach <= _LAST_REACH_UV:
        least = np.inf
        for pairs in NearPairs(lines, reach):
            own, other = pairs[chart[pairs[:, 0]] != chart[pairs[:, 1]]].T
            distances = shapely.distance(lines[own], lines[other])
            least = min(least, float(distances.min(initial=np.inf)))
        if np.isfinite(least):
            return least
        reach *= 2
    return None
