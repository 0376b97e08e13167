"""Parts of a whole unwrap: which faces and charts belong to which."""

import numpy as np
import pytest
from partuv_engine import (
    Context,
    EngineError,
    Options,
    Surface,
    build_part_tree,
    cut_tree,
    cut_tree_auto,
    unwrap,
)

from tests.support import shapes, trees
from tests.support.atlas import areas_3d


def run(mesh, *, features=None, **changed):
    options = Options()
    for name, value in changed.items():
        setattr(options, name, value)
    return unwrap(*mesh, options, Context(), features=features)


def without_noise(mesh):
    """The surface that parts are decided on."""
    return Surface(*mesh, canonical=True).denoised(None)


def assert_parts_of_the_largest_share(atlas, mesh):
    """Every chart counts to the part that most of its area lies in, or to one with as much."""
    for chart, part in enumerate(atlas.charts["part"]):
        inside = atlas.chart == chart
        share = np.bincount(atlas.part[inside], areas_3d(*mesh)[inside])
        assert share[part] >= (1 - 1e-9) * share.max()


def assert_numbered_by_first_face(part, count):
    firsts = [int(np.argmax(part == number)) for number in range(count)]
    assert set(part.tolist()) == set(range(count))
    assert firsts == sorted(firsts)


@pytest.mark.parametrize(
    "mesh",
    [
        shapes.beside(shapes.cube(3), shapes.icosphere(3), shapes.torus(24, 12)),
        trees.dumbbell(),
        shapes.loose_triangles(40),
    ],
    ids=["three things", "dumbbell", "soup"],
)
def test_parts_of_the_search_are_unions_of_charts(mesh):
    atlas = run(mesh)
    assert_numbered_by_first_face(atlas.part, atlas.part_count)
    np.testing.assert_array_equal(atlas.charts["part"][atlas.chart], atlas.part)


def test_parts_of_the_search_do_not_join_what_flattens_apart():
    cubes = shapes.beside(shapes.cube(2), shapes.cube(2))
    atlas = run(cubes)
    half = len(cubes[1]) // 2
    assert not set(atlas.part[:half]) & set(atlas.part[half:])


@pytest.mark.parametrize("parts", [1, 2, 3, 12])
def test_a_number_of_parts_cuts_the_part_tree_whatever_the_charts_are(parts):
    mesh = trees.dumbbell()
    atlas = run(mesh, parts=parts)
    surface = without_noise(mesh)
    np.testing.assert_array_equal(atlas.part, cut_tree(surface, build_part_tree(surface), parts))
    assert atlas.part_count == parts
    np.testing.assert_array_equal(atlas.corner_uv, run(mesh).corner_uv)
    assert_parts_of_the_largest_share(atlas, mesh)


def test_named_parts_are_those_of_the_automatic_cut():
    mesh = shapes.beside(trees.dumbbell(), shapes.icosphere(3))
    atlas = run(mesh, parts=0)
    surface = without_noise(mesh)
    named = cut_tree_auto(surface, build_part_tree(surface))
    np.testing.assert_array_equal(atlas.part, named)
    assert atlas.part_count == 3


def test_parts_of_features_are_cut_from_their_own_tree():
    mesh = trees.dumbbell()
    stripe = mesh[0][mesh[1]].mean(axis=1)[:, 2] > 0
    features = np.repeat(stripe[:, None], 3, axis=1).astype(np.float32)
    atlas = run(mesh, parts=2, features=features)
    np.testing.assert_array_equal(atlas.part == atlas.part[0], stripe == stripe[0])


def test_a_fine_mesh_gets_its_parts_at_full_resolution():
    mesh = shapes.icosphere(5)
    assert run(mesh).proxy_faces < len(mesh[1])
    atlas = run(mesh, parts=5)
    surface = without_noise(mesh)
    np.testing.assert_array_equal(atlas.part, cut_tree(surface, build_part_tree(surface), 5))


def test_noise_makes_no_parts():
    rng = np.random.default_rng(5)
    positions, faces = shapes.icosphere(5)
    rough = positions + 0.004 * rng.standard_normal(positions.shape)
    assert run((rough, faces), parts=0, denoise=0.0).part_count > 1
    assert run((rough, faces), parts=0).part_count == 1


def test_fewer_than_no_parts_are_refused():
    with pytest.raises(EngineError, match="parts"):
        run(shapes.cube(), parts=-2)
