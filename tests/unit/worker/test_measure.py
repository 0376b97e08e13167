import sys
from pathlib import Path

import numpy as np
import pytest
from partuv_worker.measure import measure_atlas, welded

from tests.support.glb_builder import grid
from tests.support.uv import seamless, separate_faces

SHARED = Path(__file__).parents[4] / "shared"


def two_triangles(uv):
    positions = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0.0]])
    faces = np.array([[0, 1, 2], [0, 2, 3]], np.int32)
    return measure_atlas(positions, faces, np.array(uv, np.float32)[faces], np.zeros(2, int))


def test_a_similarity_has_no_distortion_and_no_seam():
    figures = two_triangles([[0, 0], [0, 1], [-0.5, 1], [-0.5, 0]])
    assert figures.area_distortion_mean == pytest.approx(1)
    assert figures.angular_mean == pytest.approx(1)
    assert figures.seam_length == 0


def test_a_shear_costs_angle_but_no_area():
    figures = two_triangles([[0, 0], [2, 2], [2, 3], [0, 1]])  # v = y + x
    assert figures.area_distortion_mean == pytest.approx(1)
    assert figures.angular_mean == pytest.approx(1 - 1 / np.sqrt(2))


def test_unequal_scales_cost_area():
    figures = two_triangles([[0, 0], [2, 0], [2, 1], [0, 3]])  # areas 1 and 3 of surfaces 1 and 1
    assert figures.area_distortion_mean == pytest.approx((2 + 1.5) / 2)


def test_a_seam_counts_once_and_borders_do_not():
    points, faces = grid(2, 1)
    uv = seamless(points, faces)
    uv[2:] += 0.25  # the second square is another chart: the seam is one edge of length 1
    chart = np.array([0, 0, 1, 1])
    figures = measure_atlas(points.astype(float), faces, uv, chart)
    assert figures.seam_length == pytest.approx(1 / np.sqrt(2))


def test_smooth_pairs_of_faces_that_meet_in_one_edge_have_no_seam():
    points = np.array([[0, 0, 0], [0, 0, 2], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]])
    faces = np.array([[0, 1, 2], [1, 0, 4], [0, 1, 3], [1, 0, 5]])
    pair = np.array([[[0, 0], [0, 2], [1, 0]], [[0, 2], [0, 0], [-1, 0.0]]])
    uv = np.concatenate([pair, pair + np.array([3, 0])])
    chart = np.array([0, 0, 1, 1])
    assert measure_atlas(points, faces, uv, chart).seam_length == 0
    uv[3] += 1
    assert measure_atlas(points, faces, uv, np.array([0, 0, 1, 2])).seam_length == pytest.approx(1)


def test_split_vertices_are_welded_before_seams_are_sought():
    points, faces = grid(3, 2)
    uv = seamless(points, faces)
    corners = points[faces].reshape(-1, 3).astype(float)
    apart = np.arange(len(corners)).reshape(-1, 3)
    assert measure_atlas(corners, apart, uv, np.zeros(len(faces), int)).seam_length == 0


@pytest.mark.skipif(not (SHARED / "uvmetrics").is_dir(), reason="the judge is not at hand")
def test_agrees_with_the_judge(monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(SHARED)])
    from uvmetrics import evaluate

    random = np.random.default_rng(5)
    points, faces = grid(12, 9)
    points = points + random.normal(0, 0.15, points.shape)
    uv = separate_faces(len(faces)).astype(float)
    uv[40:] = seamless(points, faces)[40:] + 2
    chart = np.where(np.arange(len(faces)) < 40, np.arange(len(faces)), 40)
    ours = measure_atlas(points, faces, uv, chart)
    theirs = evaluate(points, faces, uv)
    assert ours.area_distortion_mean == pytest.approx(theirs["area_distortion_overall"])
    assert ours.angular_mean == pytest.approx(theirs["angular"])
    assert ours.seam_length == pytest.approx(theirs["seam_length_3d"])


@pytest.mark.parametrize("kind", [np.int64, np.float64])
def test_equal_rows_get_the_same_number_and_smaller_rows_smaller_ones(kind):
    rows = np.array([[2, -1], [0, 3], [1, 1], [2, -1], [1, -1], [0, 3], [0, -1]], kind)
    assert welded(rows).tolist() == [4, 1, 3, 4, 2, 1, 0]
    assert welded(rows[:0]).tolist() == []
