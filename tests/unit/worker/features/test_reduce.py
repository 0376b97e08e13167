"""Fewer dimensions must leave the part tree as it was."""

import numpy as np
from numpy.typing import NDArray
from partuv_worker.features.reduce import distance_basis, unit_rows
from scipy.spatial.distance import pdist
from sklearn.cluster import AgglomerativeClustering
from sklearn.metrics import adjusted_rand_score
from sklearn.neighbors import kneighbors_graph


def part_like_rows(count: int) -> NDArray[np.float32]:
    """448 channels: 30 smooth fields over places in space, a common offset and some noise."""
    random = np.random.default_rng(7)
    places = random.uniform(-1, 1, (count, 3))
    waves = np.sin(places @ random.normal(0, 2, (3, 30)) + random.uniform(0, 6, 30))
    rows = waves @ random.normal(0, 1, (30, 448)) + 4 + random.normal(0, 0.05, (count, 448))
    return rows.astype(np.float32)


def test_unit_rows_leave_zero_rows() -> None:
    rows = unit_rows(np.array([[3, 4], [0, 0]], np.float32))
    np.testing.assert_allclose(rows, [[0.6, 0.8], [0, 0]])


def test_distances_survive() -> None:
    rows = part_like_rows(400)
    basis = distance_basis(rows, lost=1e-3, most=448)
    assert basis.shape[0] == 448
    assert basis.shape[1] < 60
    np.testing.assert_allclose(basis.T @ basis, np.eye(basis.shape[1]), atol=1e-5)
    full, reduced = pdist(unit_rows(rows)), pdist(unit_rows(rows @ basis))
    lost = 1 - np.square(reduced).sum() / np.square(full).sum()
    assert abs(lost) <= 2e-3
    assert np.abs(full - reduced).max() <= 0.05 * full.max()


def test_less_lost_takes_more_dimensions() -> None:
    rows = part_like_rows(400)
    widths = [distance_basis(rows, lost, most=448).shape[1] for lost in (0.5, 0.1, 1e-2, 1e-6)]
    assert widths == sorted(widths)
    assert widths[0] < 15 < 60 < widths[-1]


def test_no_more_dimensions_than_allowed_and_the_main_ones_first() -> None:
    rows = part_like_rows(400)
    np.testing.assert_array_equal(
        distance_basis(rows, lost=1e-6, most=7), distance_basis(rows, lost=1e-6, most=448)[:, :7]
    )


def test_equal_rows_need_one_dimension() -> None:
    rows = np.tile(np.float32([1, 2, 2] + [0] * 445), (50, 1))
    basis = distance_basis(rows, lost=1e-3, most=448)
    np.testing.assert_allclose(unit_rows(rows @ basis) ** 2, np.ones((50, 1)), atol=1e-6)


def test_top_twenty_clusters_stay() -> None:
    rows = part_like_rows(1500)
    basis = distance_basis(rows, lost=1e-3, most=448)
    graph = kneighbors_graph(rows, 8)
    graph = graph + graph.T
    labels = [
        AgglomerativeClustering(20, connectivity=graph).fit_predict(values)
        for values in (unit_rows(rows), unit_rows(rows @ basis))
    ]
    assert adjusted_rand_score(*labels) > 0.95
