"""Pairs of shapes that are near each other, in blocks of bounded size."""

from __future__ import annotations

import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

Array = NDArray[Any]

_MOST_PAIRS = 4_000_000  # aimed at per block, which bounds the memory


class NearPairs:
    """Iterates over blocks (P x 2) of pairs of shapes within `reach`, each pair once.

    complete: false if the search ran out of time.
    """

    def __init__(self, shapes: Array, reach: float, limit_s: float = float("inf")) -> None:
        self._shapes = shapes
        self._reach = reach
        self._limit_s = limit_s
        self.complete = False

    def __iter__(self) -> Iterator[Array]:
        tree = shapely.STRtree(self._shapes)
        ends_at = time.monotonic() + self._limit_s
        # In random order: what the queries so far have cost tells what the next ones will.
        order = np.random.default_rng(0).permutation(len(self._shapes))
        done, found, step = 0, 0, 1024
        while done < len(order):
            if time.monotonic() > ends_at:
                return
            asked = order[done : done + step]
            source, other = tree.query(
                self._shapes[asked], predicate="dwithin", distance=self._reach
            )
            done += len(asked)
            found += len(source)
            step = max(1, min(4 * step, int(_MOST_PAIRS * done / max(found, 1))))
            once = asked[source] < other
            yield np.stack([asked[source][once], other[once]], axis=1)
        self.complete = True
