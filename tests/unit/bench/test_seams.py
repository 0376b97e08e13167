import numpy as np
import pytest

from bench.compare.judge.charts import find_charts
from bench.compare.judge.seams import seam_roughness
from tests.support.glb_builder import grid


def roughness(points: np.ndarray, faces: np.ndarray, group: np.ndarray) -> float | None:
    """Of a sheet that is cut between groups of faces."""
    uv = points[faces][:, :, :2] + 1000.0 * group[:, None, None]
    return seam_roughness(points, faces, find_charts(points, faces, uv))


def sheet(side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points and faces of unit cells, and the lower left corner of each face's cell."""
    points, faces = grid(side, side)
    return points.astype(float), faces, np.floor(points[faces].mean(axis=1))[:, :2]


def disc(radius: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A fan to a ring of these radii and a band around it; group 1 is the band."""
    count = len(radius)
    turn = np.arange(count) * 2 * np.pi / count
    ring = np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1)
    points = np.concatenate([[[0, 0, 0]], radius[:, None] * ring, 2 * ring])
    here = 1 + np.arange(count)
    there = np.roll(here, -1)
    fan = np.stack([0 * here, here, there], axis=1)
    low = np.stack([here, here + count, there], axis=1)
    high = np.stack([there, here + count, there + count], axis=1)
    return points, np.concatenate([fan, low, high]), np.repeat([0, 1, 1], count)


def test_a_straight_seam_is_smooth_however_its_points_lie():
    points, faces, cell = sheet(20)
    points[:, 1] += 0.3 * np.sin(7 * points[:, 1])
    assert roughness(points, faces, cell[:, 0] < 9) == pytest.approx(1, abs=1e-9)


def test_stairs_are_as_rough_as_the_diagonal_is_shorter():
    points, faces, cell = sheet(60)
    assert roughness(points, faces, cell.sum(axis=1) < 59) == pytest.approx(np.sqrt(2), rel=0.02)


def test_a_bend_over_many_edges_is_no_roughness():
    points, faces, cell = sheet(80)
    points[:, 0] += 4 * np.sin(2 * np.pi * points[:, 1] / 32)
    assert 1 < roughness(points, faces, cell[:, 0] < 40) < 1.02


def test_a_loop_does_not_shrink():
    assert roughness(*disc(np.ones(12))) == pytest.approx(1)


def test_a_zigzag_loop_is_compared_with_the_circle_in_its_middle():
    count, step = 64, 0.08
    zigzag = 1 + step * (-1.0) ** np.arange(count)
    turn = 2 * np.pi / count
    edge = np.sqrt(zigzag[0] ** 2 + zigzag[1] ** 2 - 2 * zigzag[0] * zigzag[1] * np.cos(turn))
    assert roughness(*disc(zigzag)) == pytest.approx(edge / (2 * np.sin(turn / 2)), rel=0.02)


def test_junctions_stay_where_they_are():
    points, faces, cell = sheet(30)
    quarters = 2 * (cell[:, 0] < 14) + (cell[:, 1] < 14)
    assert roughness(points, faces, quarters) == pytest.approx(1, abs=1e-9)


def test_a_sheet_without_seams_has_no_roughness():
    points, faces, cell = sheet(5)
    assert roughness(points, faces, np.zeros(len(cell))) is None
