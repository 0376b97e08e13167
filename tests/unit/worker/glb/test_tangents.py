import numpy as np
import pytest
from partuv_worker.glb.tangents import compute_tangents

from tests.support.glb_builder import grid


def sheet():
    """A flat grid that faces +z, its UVs along x and y."""
    points, faces = grid(4, 3)
    points = points.astype(float)
    return points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), points[:, :2] / 4, faces


def test_a_flat_sheet_has_the_direction_of_u():
    tangents = compute_tangents(*sheet())
    assert tangents == pytest.approx(np.tile([1, 0, 0, 1], (len(tangents), 1)))


def test_turned_uvs_turn_the_tangents():
    points, normals, uv, faces = sheet()
    tangents = compute_tangents(points, normals, np.stack([uv[:, 1], -uv[:, 0]], axis=1), faces)
    assert tangents == pytest.approx(np.tile([0, 1, 0, 1], (len(tangents), 1)))


def test_mirrored_uvs_turn_the_bitangent():
    points, normals, uv, faces = sheet()
    tangents = compute_tangents(points, normals, uv * (-1, 1), faces)
    assert tangents == pytest.approx(np.tile([-1, 0, 0, -1], (len(tangents), 1)))


def test_tangents_lie_across_the_normals_and_share_of_a_triangle_is_its_angle():
    # Two triangles at one vertex: 90 degrees with U along x, 45 degrees with U along y.
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 1, 0], [-1, 1, 0]], float)
    normals = np.tile([0.0, 0.0, 1.0], (6, 1))
    uv = np.array([[0, 0], [1, 0], [0, 1], [0, 0], [1, 0], [1, 1]], float)
    tangents = compute_tangents(points, normals, uv, np.array([[0, 1, 2], [3, 4, 5]]))
    wanted = np.array([2.0, 1.0, 0.0]) / np.sqrt(5)
    assert tangents[0, :3] == pytest.approx(wanted, abs=1e-6)
    assert tangents[0] == pytest.approx(tangents[3])  # equal position, normal and UV
    tilted = normals + np.array([0.2, 0.1, 0])
    tilted /= np.linalg.norm(tilted, axis=1, keepdims=True)
    tangents = compute_tangents(points, tilted, uv, np.array([[0, 1, 2], [3, 4, 5]]))
    assert np.einsum("ij,ij->i", tangents[:, :3], tilted) == pytest.approx(np.zeros(6), abs=1e-6)


def test_triangles_without_area_or_uvs_still_get_unit_tangents():
    points, normals, uv, faces = sheet()
    tangents = compute_tangents(points, normals, np.zeros_like(uv), faces)
    assert np.linalg.norm(tangents[:, :3], axis=1) == pytest.approx(np.ones(len(points)))
    tangents = compute_tangents(points * 0, normals, uv, faces)
    assert np.isfinite(tangents).all()
