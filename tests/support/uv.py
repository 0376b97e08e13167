"""UVs for tests that need an atlas but no engine."""

from __future__ import annotations

import numpy as np


def separate_faces(count: int) -> np.ndarray:
    """Every face in a cell of its own (count x 3 x 2): each inner vertex is split."""
    side = int(np.ceil(np.sqrt(count)))
    cell = np.arange(count)
    origin = np.stack([cell % side, cell // side], axis=1)[:, None, :]
    triangle = np.array([[0.125, 0.125], [0.75, 0.125], [0.125, 0.75]])
    return to_grid((origin + triangle) / side)


def seamless(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """One UV per position (a projection along z): no vertex is split."""
    low, high = positions.min(axis=0), positions.max(axis=0)
    scale = max((high - low)[:2].max(), 1e-12)
    return to_grid(((positions - low) / scale)[:, :2])[faces]


def to_grid(uv: np.ndarray) -> np.ndarray:
    """Round to multiples of 2^-24, as the engine does."""
    return (np.round(uv * 2.0**24) / 2.0**24).astype(np.float32)
