"""The atlas does not depend on how a mesh is numbered, placed, scaled or turned."""

import numpy as np
import pytest
from partuv_engine import Context, Options, unwrap
from scipy.spatial.transform import Rotation

from tests.support import shapes


def lumpy_pair():
    """A closed shape without symmetry, and a smaller copy of it beside."""
    positions, faces = shapes.lump()
    both = np.concatenate([positions, 0.3 * positions[:, [1, 2, 0]] + 3])
    return both, np.concatenate([faces, faces + len(positions)]).astype(np.int32)


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


@pytest.mark.parametrize("name", ["two lumps", "heap 1", "heap 2"])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_shuffled_mesh_gets_the_same_atlas(name, seed):
    positions, faces = TURNED[name]
    plain = run(positions, faces)
    other_positions, other_faces, order, corners = shapes.shuffled(positions, faces, seed)
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
