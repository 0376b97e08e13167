"""Flattenings of single pieces against maps that are known in closed form."""

import numpy as np
import pytest
from partuv_engine import EngineError, flatten

from tests.support import shapes
from tests.support.atlas import angular_score, area_distortion, areas_3d, overlaps, signed_areas

METHODS = {
    "polished": {},
    "angle-based": {"polish": False},
    "least squares": {"polish": False, "angle_based": False},
}
every_method = pytest.mark.parametrize("method", METHODS.values(), ids=METHODS)


def cone_sector(side):
    """A third of a turn of a cone between two heights."""

    def place(s, t):
        reach, turn = 1 + t, 2 * np.pi / 3 * s
        return reach * np.cos(turn), reach * np.sin(turn), -0.8 * reach

    return shapes.grid(2 * side, side, place)


def staircase(turns):
    """A flat ring that climbs a little: unrolled, it lies on itself after one turn."""

    def place(s, t):
        turn = 2 * np.pi * turns * s
        return (2 + t) * np.cos(turn), (2 + t) * np.sin(turn), 0.05 * turn

    return shapes.grid(48, 3, place)


def stereographic(positions, faces):
    """The conformal map of the sphere from its south pole."""
    x, y, z = np.moveaxis(positions[faces], -1, 0)
    return np.stack([x / (1 + z), y / (1 + z)], axis=-1)


@every_method
@pytest.mark.parametrize(
    "mesh",
    [shapes.plane(9), shapes.bent_sheet(12), cone_sector(8)],
    ids=["plane", "bent sheet", "cone"],
)
def test_developable_pieces_keep_all_lengths(mesh, method):
    positions, faces = mesh
    flat = flatten(positions, faces, **method)
    assert flat["valid"]
    assert flat["within"]
    uv = flat["corner_uv"]
    lengths_3d = np.linalg.norm(positions[faces] - np.roll(positions[faces], 1, axis=1), axis=-1)
    lengths_2d = np.linalg.norm(uv - np.roll(uv, 1, axis=1), axis=-1)
    ratio = lengths_2d / lengths_3d
    np.testing.assert_allclose(ratio, ratio.mean(), rtol=1e-3)
    assert flat["area_distortion"] == pytest.approx(1, abs=1e-4)
    assert flat["angular"] == pytest.approx(1, abs=1e-3)


@every_method
def test_figures_are_those_of_the_map(method):
    mesh = shapes.wavy(20)
    flat = flatten(*mesh, max_area_distortion=5.0, **method)
    uv = flat["corner_uv"]
    assert flat["area_distortion"] == pytest.approx(area_distortion(areas_3d(*mesh), uv))
    assert flat["angular"] == pytest.approx(angular_score(*mesh, uv))
    assert flat["flipped"] == 0
    assert (signed_areas(uv) > 0).all()
    assert not overlaps(uv)


@pytest.mark.parametrize("angle_based", [True, False])
@pytest.mark.parametrize("levels", [3, 4])
def test_a_hemisphere_gets_the_areas_of_the_stereographic_map(levels, angle_based):
    mesh = shapes.hemisphere(levels)
    ideal = stereographic(*mesh)
    flat = flatten(*mesh, polish=False, angle_based=angle_based, max_area_distortion=5.0)
    expected = area_distortion(areas_3d(*mesh), ideal)
    assert flat["area_distortion"] == pytest.approx(expected, rel=0.005)
    assert flat["angular"] == pytest.approx(angular_score(*mesh, ideal), abs=0.002)


def test_angles_improve_with_the_resolution():
    coarse, fine = (flatten(*shapes.hemisphere(n), polish=False)["angular"] for n in (2, 4))
    assert 1 - fine < 0.5 * (1 - coarse)


def test_angle_based_flattening_keeps_angles_at_least_as_well_as_least_squares():
    for mesh in (shapes.hemisphere(3), shapes.wavy(24), shapes.wavy(16, noise=0.1)):
        angle_based = flatten(*mesh, polish=False)
        least_squares = flatten(*mesh, polish=False, angle_based=False)
        assert angle_based["angular"] > least_squares["angular"] - 0.005
        assert angle_based["area_distortion"] < 1.02 * least_squares["area_distortion"]


def test_the_polish_trades_angle_for_area_within_both_bounds():
    mesh = shapes.hemisphere(4)
    conformal = flatten(*mesh, polish=False)
    assert not conformal["within"]
    polished = flatten(*mesh, min_angular=0.9)
    assert polished["within"]
    assert polished["area_distortion"] <= 1.25 < conformal["area_distortion"]
    assert 0.9 <= polished["angular"] < conformal["angular"]


def test_a_piece_that_lies_on_itself_is_not_valid():
    assert flatten(*staircase(0.9))["valid"]
    folded = flatten(*staircase(1.4))
    assert folded["flipped"] == 0
    assert not folded["valid"]
    assert not folded["within"]
    assert overlaps(folded["corner_uv"])


@pytest.mark.parametrize(
    "mesh",
    [shapes.icosphere(1), shapes.torus(12, 6), shapes.loose_triangles(2)],
    ids=["closed", "with a handle", "in two parts"],
)
def test_what_is_no_sheet_is_not_flattened(mesh):
    flat = flatten(*mesh)
    assert not flat["valid"]
    assert not flat["within"]


@pytest.mark.parametrize(("height", "tolerance"), [(1e-3, 1e-6), (1e-5, 1e-3), (0.0, 0.1)])
def test_a_needle_does_no_harm(height, tolerance):
    positions, faces = shapes.plane(6)
    positions[24] = positions[25] - [0, height, 0]
    flat = flatten(positions, faces)
    assert flat["valid"]
    assert flat["area_distortion"] == pytest.approx(1, abs=tolerance)


def test_a_broken_mesh_is_refused():
    positions, faces = shapes.plane(2)
    positions[0, 0] = np.nan
    with pytest.raises(EngineError, match="non_finite_position: vertex 0"):
        flatten(positions, faces)
