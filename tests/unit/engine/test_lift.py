"""Labels of the proxy on the full surface: whole, same topology, with straight boundaries."""

import numpy as np
import pytest
from partuv_engine import Context, EngineError, Surface

from tests.support.surfaces import box, face_crosses, region_topology, sphere, torus, with_noise


def make_surface(shape):
    positions, faces = shape
    return Surface(positions, faces.astype(np.int32))


def noisy_sphere():
    positions, faces = sphere(5)
    return with_noise(positions, 0.004), faces


def nearest_labels(surface, count, seed=0):
    """Regions around random faces, by steps over the surface: connected, with ragged boundaries."""
    label = np.full(len(surface.faces), -1, np.int32)
    opposite = surface.opposite
    front = np.random.default_rng(seed).choice(len(label), count, replace=False)
    label[front] = np.arange(count)
    while len(front):
        reached = []
        for face in front:
            for half in opposite[face]:
                if half >= 0 and label[half // 3] < 0:
                    label[half // 3] = label[face]
                    reached.append(half // 3)
        front = reached
    return label


def lift(surface, proxy, labels, band=1.0, threads=1):
    return surface.lift(proxy, labels.astype(np.int32), band, Context(threads=threads))


def cut(surface, label):
    """Vertices of the sides between two labels, K x 2."""
    opposite = surface.opposite
    face, side = np.nonzero((opposite >= 0) & (label[opposite // 3] != label[:, None]))
    once = 3 * face + side < opposite[face, side]
    faces = surface.faces
    return np.stack([faces[face, side], faces[face, (side + 1) % 3]], axis=1)[once]


def raggedness(surface, label, passes=10):
    """Length of the boundaries over their length when smoothed between their junctions."""
    edges = cut(surface, label)
    positions = surface.positions.copy()
    length = np.linalg.norm(positions[edges[:, 0]] - positions[edges[:, 1]], axis=1).sum()
    degree = np.bincount(edges.ravel(), minlength=len(positions))
    smooth = positions
    for _ in range(passes):
        total = np.zeros_like(smooth)
        np.add.at(total, edges[:, 0], smooth[edges[:, 1]])
        np.add.at(total, edges[:, 1], smooth[edges[:, 0]])
        on_line = (degree == 2)[:, None]
        smooth = np.where(on_line, 0.5 * smooth + 0.25 * total, smooth)
    return length / np.linalg.norm(smooth[edges[:, 0]] - smooth[edges[:, 1]], axis=1).sum()


@pytest.mark.parametrize("shape", [noisy_sphere(), torus(200, 60)], ids=["sphere", "torus"])
@pytest.mark.parametrize("count", [4, 25])
def test_regions_keep_their_topology(shape, count):
    surface = make_surface(shape)
    proxy = surface.simplified(2000, 0.02)
    coarse = nearest_labels(proxy, count)
    fine = lift(surface, proxy, coarse)
    assert region_topology(surface.opposite, fine) == region_topology(proxy.opposite, coarse)


def test_regions_stay_where_they_are():
    surface = make_surface(noisy_sphere())
    proxy = surface.simplified(2000, 0.02)
    coarse = nearest_labels(proxy, 12)
    fine = lift(surface, proxy, coarse)
    assert (fine == coarse[proxy.proxy_of_face]).mean() > 0.8


def test_boundaries_get_short_and_smooth():
    surface = make_surface(noisy_sphere())
    proxy = surface.simplified(2000, 0.02)
    coarse = nearest_labels(proxy, 12)
    ragged = raggedness(surface, lift(surface, proxy, coarse, band=0.0))
    straight = raggedness(surface, lift(surface, proxy, coarse))
    assert ragged > 1.3
    assert straight < 1.15


def sides_of(surface):
    crosses = face_crosses(surface.positions, surface.faces)
    axis = np.abs(crosses).argmax(axis=1)
    return 2 * axis + (np.take_along_axis(crosses, axis[:, None], 1)[:, 0] > 0)


def test_boundaries_on_creases_stay_there():
    surface = make_surface(box(24))
    proxy = surface.simplified(600, 0.02)
    fine = lift(surface, proxy, sides_of(proxy))
    assert np.array_equal(fine, sides_of(surface))


def test_a_boundary_moves_onto_a_crease_nearby():
    surface = make_surface(box(24))
    proxy = surface.simplified(6000, 0.02)
    # Two halves, cut along a wavy line around the upper edges of the cube.
    middle = proxy.positions[proxy.faces].mean(axis=1)
    top = middle[:, 2].max()
    wave = 0.01 * np.sin(40 * (middle[:, 0] + middle[:, 1]))
    coarse = (middle[:, 2] > top - 0.02 + wave).astype(np.int32)
    assert region_topology(proxy.opposite, coarse)[1] == (1, 1, 1)
    fine = lift(surface, proxy, coarse, band=3.0)
    height = surface.positions[np.unique(cut(surface, fine)), 2]
    assert height.min() == pytest.approx(surface.positions[:, 2].max(), abs=1e-9)


def test_no_label_vanishes_even_where_proxy_faces_are_many():
    surface = make_surface(sphere(4))
    proxy = surface.simplified(4000, 0.02)
    coarse = np.arange(len(proxy.faces), dtype=np.int32)
    fine = lift(surface, proxy, coarse)
    assert np.array_equal(np.unique(fine), coarse)


def test_the_result_does_not_depend_on_threads():
    surface = make_surface(noisy_sphere())
    proxy = surface.simplified(2000, 0.02)
    coarse = nearest_labels(proxy, 12)
    assert np.array_equal(
        lift(surface, proxy, coarse, threads=1), lift(surface, proxy, coarse, threads=4)
    )


def test_labels_that_do_not_fit_are_refused():
    surface = make_surface(sphere(3))
    proxy = surface.simplified(2000, 0.02)
    short = np.zeros(3, np.int32)
    negative = np.full(len(proxy.faces), -1, np.int32)
    for labels in (short, negative):
        with pytest.raises(EngineError):
            lift(surface, proxy, labels)
    other = make_surface(sphere(4))
    with pytest.raises(EngineError):
        lift(other, proxy, np.zeros(len(proxy.faces), np.int32))
