"""A mesh for the part priors to look at."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

Mesh = tuple[NDArray[np.float64], NDArray[np.int32]]


@pytest.fixture(scope="session")
def ball() -> Callable[[int], Mesh]:
    """A closed bumpy ball of 2 * n * n faces, off centre, longer than wide."""

    def build(n: int) -> Mesh:
        around, up = np.meshgrid(np.arange(n), np.arange(n + 1))
        angle, height = 2 * np.pi * around / n, np.pi * up / n
        radius = 1 + 0.2 * np.sin(3 * angle) * np.sin(height)
        positions = np.stack(
            [
                3 * radius * np.sin(height) * np.cos(angle) + 10,
                2 * radius * np.sin(height) * np.sin(angle) - 4,
                radius * np.cos(height) + 1,
            ],
            axis=-1,
        ).reshape(-1, 3)
        row, column = (index.ravel() for index in np.meshgrid(np.arange(n), np.arange(n)))
        next_column = (column + 1) % n
        a, b = row * n + column, row * n + next_column
        c, d = a + n, b + n
        faces = np.concatenate([np.stack([a, b, d], 1), np.stack([a, d, c], 1)])
        return positions, faces.astype(np.int32)

    return build
