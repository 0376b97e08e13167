"""Charts so long that they alone would keep an atlas empty are cut across."""

import numpy as np
import pytest
from partuv_engine import Context, EngineError, Options, unwrap

from tests.support import shapes
from tests.support.atlas import assert_sound


def run(mesh, face_weights=(), **changed):
    """The atlas of a mesh, after a look at everything that holds for any atlas."""
    options = Options()
    options.texel_weights.face = face_weights
    for name, value in changed.items():
        setattr(options, name, value)
    atlas = unwrap(*mesh, options, Context())
    gutter = options.gutter_texels / options.resolution
    assert_sound(*mesh, atlas, max_area_distortion=1.25, min_gutter_uv=gutter)
    return atlas


def count(atlas):
    return len(atlas.charts["faces"])


STRIP = shapes.strip(40, 4, 0.8)
LONG_STRIP = shapes.strip(80, 4, 0.25)
RING = shapes.flat_ring(48, 2, 0.85)
ARC = shapes.flat_ring(48, 2, 0.85, turn=0.8)
ROUGH = (shapes.wavy(40, seed=3)[0] * [6.0, 1.0, 0.3], shapes.wavy(40, seed=3)[1])


@pytest.mark.parametrize("mesh", [STRIP, ROUGH], ids=["strip", "rough"])
def test_one_cut_makes_the_atlas_a_quarter_denser(mesh):
    whole, cut = run(mesh, cut_below_efficiency=0.0), run(mesh)
    assert (count(whole), count(cut)) == (1, 2)
    assert cut.efficiency > 1.25 * whole.efficiency


def test_a_cut_runs_straight_across_the_middle():
    atlas = run(STRIP)
    middle = STRIP[0][STRIP[1]].mean(axis=1)[:, 0]
    for chart in (0, 1):
        assert np.ptp(middle[atlas.chart == chart]) < 2.7
    np.testing.assert_array_equal(atlas.charts["faces"], 160)


@pytest.mark.parametrize("mesh", [LONG_STRIP, ARC, RING], ids=["strip", "arc", "ring"])
def test_more_cuts_than_two_double_the_density(mesh):
    whole, cut = run(mesh, cut_below_efficiency=0.0), run(mesh)
    assert (count(whole), count(cut)) == (1, 4)
    assert cut.efficiency > 2 * whole.efficiency


@pytest.mark.parametrize(
    "mesh",
    [shapes.plane(12), shapes.cube(4), shapes.flat_ring(48, 2, 0.3), shapes.strip(1, 1, 0.5)],
    ids=["square", "cube", "disk", "two triangles"],
)
def test_what_no_cut_makes_much_denser_stays_whole(mesh):
    assert count(run(mesh)) == 1


def test_a_higher_bound_cuts_more():
    mesh = shapes.strip(20, 8, 2.5)
    assert count(run(mesh)) == 1
    assert count(run(mesh, cut_below_efficiency=0.6)) == 2


def test_the_sides_of_a_cut_belong_to_one_part():
    atlas = run(shapes.beside(LONG_STRIP, shapes.plane(4)))
    parts = [set(atlas.part[:640]), set(atlas.part[640:])]
    assert [len(part) for part in parts] == [1, 1]
    assert parts[0] != parts[1]


def test_a_small_strip_beside_a_large_plate_is_cut_only_if_weights_make_it_long():
    strip = shapes.strip(40, 2, 0.1, length=1.0)
    mesh = shapes.beside(shapes.plane(6), strip)
    assert count(run(mesh)) == 2
    assert count(run(mesh, face_weights=[1.0] * 72 + [5.0] * 160)) > 2


def test_a_tile_of_its_own_makes_a_strip_too_long():
    mesh = shapes.beside(shapes.plane(6), shapes.strip(40, 4, 0.2, length=2.0))
    assert count(run(mesh)) == 2
    options = Options()
    options.tiles = 0
    tile = unwrap(*mesh, options, Context()).charts["tile"]
    np.testing.assert_array_equal(np.sort(np.bincount(tile)), [1, 2])


def test_a_fixed_density_cuts_nothing():
    assert count(run(STRIP, texel_density=100.0)) == 1


def test_the_same_cut_whatever_the_order_of_the_faces():
    positions, faces = ROUGH
    order = np.random.default_rng(1).permutation(len(faces))
    plain, other = run(ROUGH), run((positions, faces[order]))
    np.testing.assert_array_equal(other.corner_uv, plain.corner_uv[order])
    np.testing.assert_array_equal(other.chart, plain.chart[order])


@pytest.mark.parametrize("value", [-0.1, 1.0, float("nan")])
def test_a_bound_that_is_no_share_is_refused(value):
    with pytest.raises(EngineError, match="cut_below_efficiency"):
        run(STRIP, cut_below_efficiency=value)
