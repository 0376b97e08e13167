"""A mesh is unwrapped in a frame of its own, rounded: the last digits of its place say nothing."""

import numpy as np
import pytest
from partuv_engine import Context, Options, _core, unwrap
from scipy.spatial.transform import Rotation

from tests.support import shapes


def elsewhere(positions, seed, scale):
    return np.ascontiguousarray(Rotation.random(rng=seed).apply(positions) * scale + scale)


def areas(surface):
    a, b, c = np.moveaxis(surface.positions[surface.faces], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


@pytest.mark.parametrize(
    "mesh", [shapes.lump(), shapes.cube(4), shapes.plane(6), shapes.wavy(12, noise=0.1)]
)
@pytest.mark.parametrize(("seed", "scale"), [(1, 1.0), (2, 1e4), (3, 1e-4)])
def test_a_mesh_elsewhere_gets_the_very_same_atlas(mesh, seed, scale):
    positions, faces = mesh
    here, there = (
        unwrap(p, faces, Options(), Context())
        for p in (positions, elsewhere(positions, seed, scale))
    )
    np.testing.assert_array_equal(there.corner_uv, here.corner_uv)


@pytest.mark.parametrize("mesh", [shapes.lump(), shapes.cube(4), shapes.plane(6)])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_turned_mesh_becomes_the_very_same_surface(mesh, seed):
    positions, faces = mesh
    here = _core.Surface(positions, faces, canonical=True)
    there = _core.Surface(elsewhere(positions, seed, 1.0), faces, canonical=True)
    np.testing.assert_array_equal(there.faces, here.faces)
    np.testing.assert_array_equal(there.positions, here.positions)


@pytest.mark.parametrize("height", [1e-7, 1e-10, 1e-13])
def test_thin_faces_keep_their_shape(height):
    positions, faces = shapes.with_needles(shapes.lump(), 40, height)
    plain = _core.Surface(positions, faces)
    framed = _core.Surface(elsewhere(positions, 4, 1.0), faces, canonical=True)
    order = np.argsort(framed.source_face)
    # What turning alone leaves of the thinnest is no more exact.
    turned = _core.Surface(elsewhere(positions, 4, 1.0), faces)
    slack = np.abs(areas(turned) - areas(plain))
    change = np.abs(areas(framed)[order] - areas(plain))
    assert np.all(change <= 0.03 * areas(plain) + 3 * slack)


def test_faces_without_height_do_not_keep_what_turning_leaves():
    positions, faces = shapes.with_needles(shapes.lump(), 40, 0.0)
    here, there = (
        _core.Surface(p, faces, canonical=True) for p in (positions, elsewhere(positions, 4, 1.0))
    )
    np.testing.assert_array_equal(there.faces, here.faces)
    # They are rounded so finely that a few of their coordinates still end a step apart.
    assert np.mean(there.positions != here.positions) < 0.02
    np.testing.assert_allclose(there.positions, here.positions, atol=2.0**-43)


def test_the_frame_is_a_rotation():
    positions, faces = shapes.lump()
    framed = _core.Surface(positions, faces, canonical=True)
    plain = _core.Surface(positions, faces)

    def volume(surface):
        a, b, c = np.moveaxis(surface.positions[surface.faces], 1, 0)
        return np.einsum("ij,ij->", a, np.cross(b, c))

    assert volume(framed) == pytest.approx(volume(plain), rel=1e-6)
    np.testing.assert_allclose(areas(framed)[np.argsort(framed.source_face)], areas(plain), 1e-5)
