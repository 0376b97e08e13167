import numpy as np
import pytest
from partuv_worker.features.partfield.sampling import (
    face_areas,
    face_points,
    normalised_positions,
    surface_cloud,
)

SQUARE = np.array([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0]], np.float64)
SPLIT = np.array([[0, 1, 2], [0, 2, 3]], np.int32)


@pytest.mark.parametrize(
    ("frame", "low", "high"), [("partfield", -0.9, 0.9), ("partuv", 0.05, 0.95)]
)
def test_the_longest_side_fills_the_frame(frame: str, low: float, high: float) -> None:
    placed = normalised_positions(SQUARE, frame)
    assert placed[:, 0].min() == pytest.approx(low)
    assert placed[:, 0].max() == pytest.approx(high)
    assert placed.mean(axis=0) == pytest.approx([(low + high) / 2] * 3)


def test_scale_and_place_of_the_mesh_do_not_matter_and_the_mesh_is_left_alone() -> None:
    moved = SQUARE * 1e-4 + [300.0, -2.0, 7.0]
    before = moved.copy()
    np.testing.assert_allclose(
        normalised_positions(moved, "partfield"),
        normalised_positions(SQUARE, "partfield"),
        atol=1e-9,
    )
    np.testing.assert_array_equal(moved, before)


def test_a_single_place_maps_to_the_centre() -> None:
    placed = normalised_positions(np.full((3, 3), 5.0), "partfield")
    np.testing.assert_array_equal(placed, np.zeros((3, 3)))


def test_cloud_lies_on_the_faces_by_area() -> None:
    positions = np.array([*SQUARE, [0, 1, 3]], np.float64)
    faces = np.array([[0, 1, 2], [0, 3, 4]], np.int32)  # areas 2 and 1.5
    points, face = surface_cloud(positions, faces, 20_000, seed=1)
    assert points.dtype == np.float32
    assert (face == 0).mean() == pytest.approx(2 / 3.5, abs=0.02)
    flat, upright = points[face == 0], points[face == 1]
    assert np.abs(flat[:, 2]).max() == 0
    assert (flat[:, 1] <= flat[:, 0] / 4 + 1e-6).all()
    assert np.abs(upright[:, 0]).max() == 0
    # Even within the face: its centroid is the mean.
    assert flat.mean(axis=0) == pytest.approx([8 / 3, 1 / 3, 0], abs=0.03)


def test_cloud_depends_on_the_seed_alone() -> None:
    first, _ = surface_cloud(SQUARE, SPLIT, 100, seed=1)
    again, _ = surface_cloud(SQUARE, SPLIT, 100, seed=1)
    other, _ = surface_cloud(SQUARE, SPLIT, 100, seed=2)
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()


def test_a_surface_without_area_is_sampled_all_the_same() -> None:
    faces = np.array([[0, 0, 1], [2, 2, 2]], np.int32)
    points, face = surface_cloud(SQUARE, faces, 50, seed=1)
    assert set(face) == {0, 1}
    assert np.isfinite(points).all()
    assert face_areas(SQUARE, faces).max() == 0


def test_face_points_are_even_over_the_face() -> None:
    corners = np.array([[[0, 0, 0], [1, 0, 0], [0, 1, 0]]], np.float32)
    draws = np.random.default_rng(1).random((1, 40_000, 2), dtype=np.float32)
    points = face_points(corners, draws)[0]
    assert points.dtype == np.float32
    assert (points[:, :2] >= 0).all()
    assert (points.sum(axis=1) <= 1 + 1e-6).all()
    # A quarter of the area lies within half of the height, seen from each corner.
    for distance in (points[:, 0] + points[:, 1], 1 - points[:, 0], 1 - points[:, 1]):
        assert (distance < 0.5).mean() == pytest.approx(0.25, abs=0.01)
