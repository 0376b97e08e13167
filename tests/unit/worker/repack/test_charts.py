import numpy as np
import pytest
from partuv_worker.repack.charts import connected, find_charts
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from tests.support.glb_builder import grid


def sheet(columns=4, rows=2):
    """A flat grid, and UVs that are its plane."""
    points, faces = grid(columns, rows)
    return points.astype(float), faces, points[:, :2].astype(float)[faces]


def charts(points, faces, uv, primitive=None, mesh=None):
    zeros = np.zeros(len(faces), int)
    primitive = zeros if primitive is None else primitive
    return find_charts(points, faces, uv, primitive, zeros if mesh is None else mesh)


def test_a_seam_parts_charts_and_they_are_numbered_by_first_faces():
    points, faces, uv = sheet()
    assert charts(points, faces, uv).tolist() == [0] * 16
    right = points[faces][..., 0].min(axis=1) >= 2
    uv[right] += 0.001
    assert (charts(points, faces, uv) == right).all()


def test_split_vertices_are_joined_where_positions_and_uvs_are_equal():
    points, faces, uv = sheet()
    apart = np.arange(faces.size).reshape(-1, 3)
    assert not charts(points[faces].reshape(-1, 3), apart, uv).any()


def test_one_common_corner_joins_nothing():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]])
    faces = np.array([[0, 1, 2], [0, 3, 4]])
    assert charts(points, faces, points[faces][..., :2]).tolist() == [0, 1]


def test_mirrored_halves_that_share_texels_are_two_charts():
    points, faces, uv = sheet()
    uv[..., 0] = np.abs(uv[..., 0] - 2)
    left = points[faces][..., 0].max(axis=1) <= 2
    assert (charts(points, faces, uv) == ~left).all()


def test_a_small_fold_stays_in_its_chart():
    points, faces, uv = sheet(8, 8)
    uv[(uv == (4, 4)).all(axis=-1)] = (5.4, 4)
    assert not charts(points, faces, uv).any()


def test_both_sides_of_a_sheet_are_two_charts():
    points, faces, uv = sheet()
    both, both_uv = np.concatenate([faces, faces[:, ::-1]]), np.concatenate([uv, uv[:, ::-1]])
    assert charts(points, both, both_uv).tolist() == [0] * 16 + [1] * 16


def test_a_second_copy_of_a_primitive_leaves_the_first_whole():
    points, faces, uv = sheet()
    primitive = np.repeat([0, 1], 16)
    twice = charts(points, np.tile(faces, (2, 1)), np.tile(uv, (2, 1, 1)), primitive)
    assert (twice == primitive).all()


def test_charts_cross_the_primitives_of_a_mesh_but_not_meshes():
    points, faces, uv = sheet()
    half = np.arange(16) // 8
    assert not charts(points, faces, uv, half).any()
    assert (charts(points, faces, uv, half, half) == half).all()


def test_a_face_that_is_wound_the_wrong_way_stays_in_its_chart():
    points, faces, uv = sheet()
    faces[5], uv[5] = faces[5, ::-1].copy(), uv[5, ::-1].copy()
    assert not charts(points, faces, uv).any()


def test_three_sheets_on_one_edge_are_three_charts():
    points = np.array([[0, 0, 0], [0, 1, 0], [1, 0, 0], [-1, 0, 0], [0, 0, 1.0]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 1, 4]])
    uv = np.array([[0, 0], [0, 1], [1, 0], [-1, 0], [-1, 0.5]])[faces]
    assert charts(points, faces, uv).tolist() == [0, 1, 2]


@pytest.mark.parametrize("seed", range(5))
def test_connected_agrees_with_scipy(seed):
    random = np.random.default_rng(seed)
    first, second = random.integers(0, 300, (2, 200 + 50 * seed))
    links = coo_matrix((np.ones(len(first)), (first, second)), (300, 300))
    _, wanted = connected_components(links, directed=False)
    found = connected(300, first, second)
    lowest = np.full(wanted.max() + 1, 300)
    np.minimum.at(lowest, wanted, np.arange(300))
    assert (found == lowest[wanted]).all()


def test_a_long_chain_is_connected():
    order = np.random.default_rng(1).permutation(100_000)
    assert not connected(100_000, order[1:], order[:-1]).any()
