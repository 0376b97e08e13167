"""The atlas does not depend on how a mesh is numbered, placed, scaled or turned."""

import numpy as np
import pytest
from partuv_engine import Context, Options, _core, unwrap
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation

from tests.support import shapes


def lumpy_pair():
    """A closed shape without symmetry, and a smaller copy of it beside."""
    positions, faces = shapes.icosphere(3)
    x, y, z = positions.T
    radius = 1 + 0.25 * np.sin(3 * x) * np.cos(2 * y + 1) + 0.2 * np.sin(4 * z + x)
    lump = positions * radius[:, None]
    both = np.concatenate([lump, 0.3 * lump[:, [1, 2, 0]] + 3])
    return both, np.concatenate([faces, faces + len(lump)]).astype(np.int32)


def mirrored_wave():
    """A sheet that is its own mirror image."""
    positions, faces = shapes.wavy(14)
    positions[:, 2] = 0.2 * np.cos(5 * (positions[:, 0] - 0.5)) * positions[:, 1] ** 2
    return positions, faces


def comb():
    """A block with slots: faces in six directions only, flaps that lie side by side unfolded."""
    solid = np.ones((9, 5, 4), dtype=bool)
    solid[1::2, :, 2:] = False
    solid[:, 2, 3] = False
    return shapes.blocks(solid)


def heap(seed):
    """Unit cubes at random on a plate."""
    solid = np.random.default_rng(seed).random((5, 5, 4)) < 0.6
    solid[:, :, 0] = True
    return shapes.blocks(solid)


def doubled(mesh, share):
    """The mesh with the first share of its faces there a second time, wound the other way round."""
    positions, faces = mesh
    return positions, np.concatenate([faces, faces[: round(share * len(faces)), ::-1]])


def touching_blocks():
    """A cube and a longer block that touch along a wall, each wound outwards."""
    positions, faces = shapes.blocks(np.ones((3, 1, 1), dtype=bool))
    at = {tuple(p): v for v, p in enumerate((positions - positions.min(0)).astype(int))}
    a, b, c, d = at[1, 0, 0], at[1, 1, 0], at[1, 1, 1], at[1, 0, 1]
    wall = np.array([[a, b, c], [a, c, d]], np.int32)
    return positions, np.concatenate([faces, wall, wall[:, ::-1]])


MESHES = {"two lumps": lumpy_pair(), "mirrored": mirrored_wave(), "cube": shapes.cube(4)}
TURNED = {
    "two lumps": lumpy_pair(),
    "mirrored": mirrored_wave(),
    "holes": shapes.plate_with_holes(5),
    "comb": comb(),
    "heap 1": heap(1),
    "heap 2": heap(2),
    # Flaps touch when they are unfolded, sides are as long and charts as large as others.
    "heap 3": heap(3),
    "heap 4": heap(4),
    "heap 12": heap(12),
}


def run(positions, faces, cut_below_efficiency=0.47):
    options = Options()
    options.cut_below_efficiency = cut_below_efficiency
    return unwrap(np.ascontiguousarray(positions), faces, options, Context())


def shuffled(positions, faces, seed):
    """The mesh with its vertices, faces and corners in another order, and the orders of the two."""
    random = np.random.default_rng(seed)
    vertices, order = random.permutation(len(positions)), random.permutation(len(faces))
    number = np.argsort(vertices).astype(np.int32)
    corners = (random.integers(0, 3, (len(faces), 1)) + np.arange(3)) % 3
    renamed = np.take_along_axis(number[faces][order], corners, axis=1)
    return positions[vertices], renamed, order, corners


@pytest.mark.parametrize("name", ["two lumps", "heap 1", "heap 2"])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_shuffled_mesh_gets_the_same_atlas(name, seed):
    positions, faces = TURNED[name]
    plain = run(positions, faces)
    other_positions, other_faces, order, corners = shuffled(positions, faces, seed)
    other = run(other_positions, other_faces)
    expected = np.take_along_axis(plain.corner_uv[order], corners[..., None], axis=1)
    np.testing.assert_array_equal(other.corner_uv, expected)
    np.testing.assert_array_equal(other.chart, plain.chart[order])


@pytest.mark.parametrize("name", TURNED)
@pytest.mark.parametrize("seed", [1, 2, 4])
def test_a_turned_mesh_is_cut_into_the_same_charts(name, seed):
    positions, faces = TURNED[name]
    turned = Rotation.random(rng=seed).apply(positions) * 1e3 + [5, -70, 20]
    np.testing.assert_array_equal(run(turned, faces).chart, run(positions, faces).chart)


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize(
    "place",
    [
        lambda p: p * 1e-4,
        lambda p: p * 1e4,
        lambda p: p + 1000 * np.ptp(p),
        lambda p: Rotation.random(rng=3).apply(p),
        lambda p: Rotation.random(rng=4).apply(p).astype(np.float32).astype(float),
    ],
    ids=["small", "large", "far away", "turned", "turned and rounded"],
)
def test_the_charts_are_as_many_however_the_mesh_lies(name, place):
    # A cube has several nets, of which some are long enough to be cut.
    positions, faces = MESHES[name]
    here, there = run(positions, faces, 0.0), run(place(positions), faces, 0.0)
    assert len(there.charts["faces"]) == len(here.charts["faces"])


def test_an_edge_of_three_faces_leaves_no_slit():
    positions, faces = shapes.plane(6)
    middle = int(np.argmin(np.linalg.norm(positions - [0.5, 0.5, 0], axis=1)))
    after = next(int(b) for a, b in _edges(faces) if a == middle)
    fin = [middle, after, len(positions)]
    with_fin = np.concatenate([positions, positions[middle][None] + [0, 0, 1]])
    surface = _core.Surface(with_fin, np.concatenate([faces, [fin]]).astype(np.int32))
    assert np.count_nonzero(surface.opposite < 0) == 24 + 3  # the rim of the sheet, and the fin
    atlas = run(with_fin, np.concatenate([faces, [fin]]).astype(np.int32))
    assert sorted(atlas.charts["faces"]) == [1, len(faces)]


@pytest.mark.parametrize(
    ("mesh", "bodies"),
    [
        (doubled(shapes.plane(6), 1.0), [72, 72]),
        (doubled(shapes.plane(6), 0.5), [72, 36]),
        (doubled(shapes.icosphere(2), 1.0), [320, 320]),
        (doubled(doubled(shapes.plane(6), 1.0), 1.0), [72] * 4),
        (touching_blocks(), [12, 20]),
    ],
    ids=["sheet", "sheet with half a back", "ball", "two sheets with backs", "touching blocks"],
)
@pytest.mark.parametrize("seed", [None, 1, 2])
def test_sheets_that_lie_on_each_other_stay_whole_and_apart(mesh, bodies, seed):
    positions, faces = mesh if seed is None else shuffled(*mesh, seed)[:2]
    surface = _core.Surface(positions, np.ascontiguousarray(faces))
    f, k = np.nonzero(surface.opposite >= 0)
    links = coo_array((np.ones(len(f)), (f, surface.opposite[f, k] // 3)), (len(faces),) * 2)
    _, body = connected_components(links)
    assert sorted(np.bincount(body)) == sorted(bodies)


def test_four_faces_at_an_edge_that_could_pair_either_way_do_not():
    around = [[0, 1, 0], [0, 0, 1], [0, -1, 0], [0, 0, -1]]
    positions = np.array([[0, 0, 0], [1, 0, 0], *around], float)
    faces = np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4], [1, 0, 5]], np.int32)
    assert np.all(_core.Surface(positions, faces).opposite < 0)


def _edges(faces):
    return [(a, b) for t in faces for a, b in zip(t, np.roll(t, -1), strict=True)]
