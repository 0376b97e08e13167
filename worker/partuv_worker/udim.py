"""Texture tiles in one UV space: tile 0 is 1001, ten to a row, rows upwards."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

_FIRST = 1001
_ROW = 10


def udim_number(tile: int) -> int:
    """The number by which painting tools know a tile."""
    return _FIRST + tile


def in_udim(corner_uv: NDArray[np.float32], tile: NDArray[np.int32]) -> NDArray[np.float32]:
    """UVs moved from the unit square into their tiles.

    corner_uv: F x 3 x 2, V up. tile: F. Nothing is rounded: the engine leaves as many bits free as
    the last tile needs.
    """
    origin = np.stack([tile % _ROW, tile // _ROW], axis=-1).astype(np.float32)
    moved: NDArray[np.float32] = corner_uv + origin[:, None, :]
    return moved


def udim_extras(tile_count: int) -> dict[str, Any]:
    """What the GLB says of its tiles."""
    numbers = [udim_number(tile) for tile in range(tile_count)]
    return {"partuv": {"tiles": {"layout": "udim", "numbers": numbers}}}
