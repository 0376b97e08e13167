"""The proxy of a surface: same topology, close to it, and every source face at home on it."""

import numpy as np
import pytest
from partuv_engine import Context, Surface

from tests.support.surfaces import (
    box,
    face_areas,
    face_crosses,
    grid_sheet,
    region_topology,
    sphere,
    torus,
    with_noise,
)


def make_surface(shape):
    positions, faces = shape
    return Surface(positions, faces.astype(np.int32))


def simplify(surface, target, threads=1):
    return surface.simplified(target, 0.02, Context(threads=threads))


def whole(surface):
    label = np.zeros(len(surface.faces), int)
    return region_topology(surface.opposite, label)[0]


def two_balls_and_a_sheet():
    ball, ball_faces = sphere(4)
    sheet, sheet_faces = grid_sheet(40, 40)
    positions = np.concatenate([ball, ball + np.array([3, 0, 0]), sheet / 20 + np.array([6, 0, 0])])
    faces = [ball_faces, ball_faces + len(ball), sheet_faces + 2 * len(ball)]
    return positions, np.concatenate(faces)


def frame():
    """A square sheet with a square hole: two boundary loops."""
    positions, faces = grid_sheet(60, 60)
    middle = positions[faces].mean(axis=1)[:, :2]
    return positions, faces[~((middle > 20) & (middle < 40)).all(axis=1)]


SHAPES = {
    "sphere": sphere(5),
    "noisy sphere": (with_noise(sphere(5)[0], 0.004), sphere(5)[1]),
    "torus": torus(120, 40),
    "box": box(30),
    "sheet": grid_sheet(60, 60),
    "frame": frame(),
    "three components": two_balls_and_a_sheet(),
}


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
def test_topology_and_links_survive(shape):
    source = make_surface(shape)
    coarse = simplify(source, 1000)
    assert 500 <= len(coarse.faces) <= 1000
    assert whole(coarse) == whole(source)
    faces, opposite = coarse.faces, coarse.opposite
    face, side = np.nonzero(opposite >= 0)
    other, other_side = np.divmod(opposite[face, side], 3)
    assert np.array_equal(opposite[other, other_side], 3 * face + side)
    assert np.array_equal(faces[face, side], faces[other, (other_side + 1) % 3])
    assert np.array_equal(faces[face, (side + 1) % 3], faces[other, other_side])
    assert len(np.unique(faces)) == len(coarse.positions)


@pytest.mark.parametrize("shape", SHAPES.values(), ids=SHAPES.keys())
def test_each_source_face_lies_on_its_proxy_face(shape):
    source = make_surface(shape)
    coarse = simplify(source, 1000)
    home = coarse.proxy_of_face
    assert home.shape == (len(source.faces),)
    assert home.min() >= 0
    crosses = face_crosses(coarse.positions, coarse.faces)
    normals = crosses / np.linalg.norm(crosses, axis=1, keepdims=True)
    middle = source.positions[source.faces].mean(axis=1)
    corner = coarse.positions[coarse.faces[home, 0]]
    # The surface has unit area: the mean proxy edge is about 0.05.
    assert np.abs(((middle - corner) * normals[home]).sum(axis=1)).max() < 0.02
    centre = coarse.positions[coarse.faces].mean(axis=1)
    assert np.linalg.norm(middle - centre[home], axis=1).max() < 0.25
    # The sets are connected, and next to none is empty.
    assert all(parts == 1 for parts, _, _ in region_topology(source.opposite, home).values())
    assert len(np.unique(home)) > 0.99 * len(coarse.faces)


def test_area_stays_and_triangles_are_well_shaped():
    source = make_surface(SHAPES["torus"])
    coarse = simplify(source, 1000)
    areas = face_areas(coarse.positions, coarse.faces)
    assert areas.sum() == pytest.approx(1.0, rel=0.03)
    a, b, c = np.moveaxis(coarse.positions[coarse.faces], 1, 0)
    squares = ((b - a) ** 2 + (c - b) ** 2 + (a - c) ** 2).sum(axis=1)
    quality = 4 * np.sqrt(3) * areas / squares
    assert quality.min() > 0.05
    assert np.median(quality) > 0.6


def test_a_box_keeps_its_edges_and_sides():
    source = make_surface(box(30))
    coarse = simplify(source, 300)

    def facing(surface):
        crosses = face_crosses(surface.positions, surface.faces)
        share = np.abs(crosses) / np.linalg.norm(crosses, axis=1, keepdims=True)
        assert share.max(axis=1).min() > 1 - 1e-9
        axis = share.argmax(axis=1)
        return 2 * axis + (np.take_along_axis(crosses, axis[:, None], 1)[:, 0] > 0)

    assert np.array_equal(facing(source), facing(coarse)[coarse.proxy_of_face])
    assert face_areas(coarse.positions, coarse.faces).sum() == pytest.approx(1.0, rel=1e-9)


def test_needles_of_a_flat_face_go_below_the_target():
    # A sheet with two columns of vertices close together: one strip of needles.
    positions, faces = grid_sheet(3, 40)
    positions[:, 0] = np.array([0.0, 19.99, 20.01, 40.0])[positions[:, 0].astype(int)]
    source = make_surface((positions, faces))

    def needles(surface):
        areas = face_areas(surface.positions, surface.faces)
        a, b, c = np.moveaxis(surface.positions[surface.faces], 1, 0)
        squares = ((b - a) ** 2 + (c - b) ** 2 + (a - c) ** 2).sum(axis=1)
        return int((4 * np.sqrt(3) * areas / squares < 0.1).sum())

    proxy = simplify(source, 10000)
    assert needles(source) >= 80
    assert needles(proxy) <= 4
    assert face_areas(proxy.positions, proxy.faces).sum() == pytest.approx(1.0)


def test_a_clean_surface_below_the_target_is_left_alone():
    source = make_surface(sphere(4))
    proxy = simplify(source, 10000)
    assert np.array_equal(proxy.faces, source.faces)
    assert np.array_equal(proxy.proxy_of_face, np.arange(len(source.faces)))


def test_no_small_component_vanishes():
    ball, ball_faces = sphere(1)
    big, big_faces = sphere(5)
    offsets = [[4 + 0.1 * i, 0, 0] for i in range(50)]
    positions = np.concatenate([big] + [0.02 * ball + offset for offset in offsets])
    faces = [big_faces] + [ball_faces + len(big) + i * len(ball) for i in range(50)]
    source = make_surface((positions, np.concatenate(faces)))
    proxy = simplify(source, 2000)
    assert whole(proxy)[0] == 51
    assert 4000 < len(proxy.faces) < 6000


def test_the_result_does_not_depend_on_threads():
    source = make_surface(SHAPES["noisy sphere"])
    one, four = simplify(source, 2000, threads=1), simplify(source, 2000, threads=4)
    assert np.array_equal(one.faces, four.faces)
    assert np.array_equal(one.positions, four.positions)
    assert np.array_equal(one.proxy_of_face, four.proxy_of_face)
