"""How rough a surface is, and smoothing that leaves creases alone."""

import numpy as np
import pytest
from partuv_engine import Context, Surface

from tests.support.surfaces import box, grid_sheet, sphere, torus, with_noise


def make_surface(shape):
    positions, faces = shape
    return Surface(positions, faces.astype(np.int32))


def denoised(surface, strength=None, threads=1):
    return surface.denoised(strength, Context(threads=threads))


def rough_ball(share_of_edge):
    """A sphere with radial white noise of this share of its mean edge."""
    positions, faces = sphere(5)
    edge = np.linalg.norm(positions[faces[:, 0]] - positions[faces[:, 1]], axis=1).mean()
    radius = 1 + share_of_edge * edge * np.random.default_rng(3).normal(size=(len(positions), 1))
    return positions * radius, faces


CLEAN = {
    "sphere": sphere(5),
    "coarse torus": torus(60, 24),
    "box": box(20),
    "two triangles a side": box(1),
    "sheet": grid_sheet(30, 30),
}


@pytest.mark.parametrize("shape", CLEAN.values(), ids=CLEAN.keys())
def test_clean_surfaces_have_no_noise_and_are_not_touched(shape):
    surface = make_surface(shape)
    assert surface.noise() < 0.01
    assert np.array_equal(denoised(surface).positions, surface.positions)


def test_noise_grows_with_its_amplitude_whatever_the_scale():
    measured = [make_surface(rough_ball(share)).noise() for share in (0.01, 0.05, 0.1)]
    assert 0.002 < measured[0] < measured[1] < measured[2]
    assert measured[1] > 0.02
    positions, faces = rough_ball(0.05)
    assert make_surface((1e4 * positions, faces)).noise() == pytest.approx(measured[1], rel=1e-6)


def test_a_rough_ball_gets_round():
    surface = make_surface(rough_ball(0.1))

    def spread(s):
        radius = np.linalg.norm(s.positions - s.positions.mean(axis=0), axis=1)
        return radius.std() / radius.mean()

    smooth = denoised(surface)
    assert smooth.noise() < 0.6 * surface.noise()
    assert spread(smooth) < 0.6 * spread(surface)
    radius = np.linalg.norm(smooth.positions, axis=1).mean()
    assert radius == pytest.approx(np.linalg.norm(surface.positions, axis=1).mean(), rel=0.01)


def test_creases_of_a_noisy_box_stay_sharp():
    cells = 24
    positions, faces = box(cells)
    welded, index = np.unique(positions, axis=0, return_inverse=True)
    surface = Surface(with_noise(welded, 0.04), index[faces].astype(np.int32))
    smooth = denoised(surface, 3.0)
    assert smooth.noise() < 0.7 * surface.noise()
    # Corners keep their place and edges stay as far out as the sides are.
    scale = np.ptp(smooth.positions, axis=0).mean() / cells
    low, high = smooth.positions.min(axis=0), smooth.positions.max(axis=0)
    outside = np.minimum(smooth.positions - low, high - smooth.positions)
    at_edges = ((welded == 0) | (welded == cells)).sum(axis=1) >= 2
    order = np.unique(index[faces], return_index=True)[1]
    corner = smooth.positions[smooth.faces.ravel()[order]]
    nearest = np.sort(np.minimum(corner - low, high - corner), axis=1)[at_edges, 1]
    assert outside.min() >= 0
    assert np.median(nearest) < 0.3 * scale


def test_boundaries_are_smoothed_along_themselves():
    positions, faces = grid_sheet(30, 30)
    surface = make_surface((positions, faces))
    smooth = denoised(surface, 2.0)
    assert np.allclose(smooth.positions, surface.positions, atol=1e-12)


def test_strength_zero_changes_nothing():
    surface = make_surface(rough_ball(0.1))
    assert np.array_equal(denoised(surface, 0.0).positions, surface.positions)


def test_only_the_noisy_component_is_smoothed():
    rough, faces = rough_ball(0.1)
    clean, _ = sphere(5)
    both = np.concatenate([rough, clean + np.array([4, 0, 0])])
    surface = make_surface((both, np.concatenate([faces, faces + len(rough)])))
    moved = np.linalg.norm(denoised(surface).positions - surface.positions, axis=1) > 0
    first = np.zeros(len(surface.positions), bool)
    first[np.unique(surface.faces[: len(faces)])] = True
    assert moved[first].all()
    assert not moved[~first].any()


def test_the_result_does_not_depend_on_threads():
    surface = make_surface(rough_ball(0.1))
    one, four = denoised(surface, threads=1), denoised(surface, threads=4)
    assert np.array_equal(one.positions, four.positions)
