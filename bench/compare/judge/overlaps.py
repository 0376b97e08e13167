"""Pairs of UV triangles that lie on one another."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from bench.compare.judge.pairs import NearPairs

Array = NDArray[Any]

DEPTH_UV = 1e-6  # triangles that reach less far into each other only touch


@dataclass(frozen=True)
class Overlaps:
    pairs: Array  # P x 2 face numbers
    complete: bool  # false if the search ran out of time


def find_overlaps(corner_uv: Array, faces: Array, limit_s: float) -> Overlaps:
    """Pairs among the given faces that penetrate each other. corner_uv: F x 3 x 2."""
    triangles = corner_uv[faces]
    first, second = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    clockwise = first[:, 0] * second[:, 1] < first[:, 1] * second[:, 0]
    triangles[clockwise] = triangles[clockwise][:, ::-1]
    boxes = shapely.box(*triangles.min(axis=1).T, *triangles.max(axis=1).T)
    candidates = NearPairs(boxes, 0.0, limit_s)
    pairs = [np.zeros((0, 2), np.int64)]
    pairs += [block[_penetrate(triangles, block)] for block in candidates]
    return Overlaps(faces[np.concatenate(pairs)], candidates.complete)


def _penetrate(triangles: Array, pairs: Array) -> Array:
    """Separating axes: the least depth over the inner normals of all six sides counts."""
    deep = np.arange(len(pairs))
    for own, other in ((0, 1), (1, 0)):
        for side in range(3):
            mine, theirs = triangles[pairs[deep, own]], triangles[pairs[deep, other]]
            start = mine[:, side]
            along = mine[:, (side + 1) % 3] - start
            along /= np.linalg.norm(along, axis=1, keepdims=True)
            reach = theirs - start[:, None]
            depth = along[:, None, 0] * reach[..., 1] - along[:, None, 1] * reach[..., 0]
            deep = deep[depth.max(axis=1) > DEPTH_UV]
    penetrate: Array = np.zeros(len(pairs), bool)
    penetrate[deep] = True
    return penetrate
