"""Triangles of an implicit surface by naive surface nets (Gibson 1998), then pulled onto it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

_PULLS = 4  # Newton steps from the net to the surface


def extract_surface(
    field: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    low: Sequence[float],
    high: Sequence[float],
    cell: float,
) -> tuple[NDArray[np.float32], NDArray[np.uint32], NDArray[np.float32]]:
    """Positions (V x 3), faces (F x 3) and normals (V x 3) of field = 0 within a box.

    The field is negative inside and must be positive on the border of the box. One vertex per grid
    cell that the surface crosses, one quad per grid edge that it crosses.
    """
    shape = tuple(int(n) for n in np.ceil(np.subtract(high, low) / cell).astype(int) + 1)
    corner = np.array(low, np.float64)
    grid = np.stack(np.meshgrid(*map(np.arange, shape), indexing="ij"), axis=-1).reshape(-1, 3)
    values = field(corner + grid * cell).reshape(shape)
    corners = np.stack(
        [
            values[i : shape[0] - 1 + i, j : shape[1] - 1 + j, k : shape[2] - 1 + k]
            for i in (0, 1)
            for j in (0, 1)
            for k in (0, 1)
        ]
    )
    crossed = (corners.min(axis=0) < 0) & (corners.max(axis=0) >= 0)
    number = np.full(crossed.shape, -1, np.int64)
    number[crossed] = np.arange(crossed.sum())
    positions: NDArray[np.float64] = corner + (np.argwhere(crossed) + 0.5) * cell
    for _ in range(_PULLS):
        normals = _gradient(field, positions, cell / 8)
        squared = np.maximum((normals**2).sum(axis=1), 1e-12)
        step = np.clip(field(positions) / squared, -cell / 2, cell / 2)
        positions = positions - step[:, None] * normals
    normals = _gradient(field, positions, cell / 8)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    faces = np.concatenate([_quads(values, number, axis) for axis in range(3)])
    return positions.astype(np.float32), faces.astype(np.uint32), normals.astype(np.float32)


def _quads(values: NDArray[np.float64], number: NDArray[np.int64], axis: int) -> NDArray[np.int64]:
    """Two triangles around each grid edge along an axis with a change of sign."""
    inside = np.moveaxis(values < 0, axis, 0)
    cells = np.moveaxis(number, axis, 0)
    if axis == 1:  # moving an axis by one turns a right-handed frame left-handed
        inside, cells = inside.swapaxes(1, 2), cells.swapaxes(1, 2)
    start, end = inside[:-1, 1:-1, 1:-1], inside[1:, 1:-1, 1:-1]
    quads = np.stack(
        [cells[:, :-1, :-1], cells[:, 1:, :-1], cells[:, 1:, 1:], cells[:, :-1, 1:]], axis=-1
    )
    leaving, entering = quads[start & ~end], quads[~start & end][:, ::-1]
    both = np.concatenate([leaving, entering])
    return both[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)


def _gradient(
    field: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    points: NDArray[np.float64],
    step: float,
) -> NDArray[np.float64]:
    offsets = np.eye(3) * step
    return np.stack(
        [(field(points + offset) - field(points - offset)) / (2 * step) for offset in offsets],
        axis=1,
    )
