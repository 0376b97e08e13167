"""UVs in their tiles, exact in single precision."""

import numpy as np
from partuv_worker.udim import in_udim, udim_extras, udim_number


def test_tiles_lie_ten_to_a_row_and_nothing_is_rounded():
    tile = np.array([0, 1, 9, 10, 99], np.int32)
    steps = np.random.default_rng(1).integers(0, 2**20 + 1, (5, 3, 2))
    uv = (steps / 2**20).astype(np.float32)
    moved = in_udim(uv, tile)
    assert moved.dtype == np.float32
    origin = np.array([[0, 0], [1, 0], [9, 0], [0, 1], [9, 9]])
    np.testing.assert_array_equal(moved.astype(np.float64) - origin[:, None], steps / 2**20)
    flipped = (1 - moved).astype(np.float64)
    np.testing.assert_array_equal(1 - flipped, moved.astype(np.float64))


def test_numbers_are_those_of_painting_tools():
    assert [udim_number(tile) for tile in (0, 1, 9, 10)] == [1001, 1002, 1010, 1011]
    assert udim_extras(2) == {"partuv": {"tiles": {"layout": "udim", "numbers": [1001, 1002]}}}
