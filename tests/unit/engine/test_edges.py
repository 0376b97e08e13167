"""Which faces meet at edges of more than two."""

import numpy as np
import pytest
from partuv_engine import Context, Options, _core, unwrap
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial.transform import Rotation

from tests.support import shapes


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


def sizes_of_bodies(positions, faces):
    """How many faces hang together, ascending."""
    surface = _core.Surface(positions, np.ascontiguousarray(faces))
    f, k = np.nonzero(surface.opposite >= 0)
    links = coo_array((np.ones(len(f)), (f, surface.opposite[f, k] // 3)), (len(faces),) * 2)
    _, body = connected_components(links)
    return sorted(np.bincount(body))


def test_an_edge_of_three_faces_leaves_no_slit():
    positions, faces = shapes.plane(6)
    middle = int(np.argmin(np.linalg.norm(positions - [0.5, 0.5, 0], axis=1)))
    after = next(int(b) for a, b in _edges(faces) if a == middle)
    fin = [middle, after, len(positions)]
    with_fin = np.concatenate([positions, positions[middle][None] + [0, 0, 1]])
    surface = _core.Surface(with_fin, np.concatenate([faces, [fin]]).astype(np.int32))
    assert np.count_nonzero(surface.opposite < 0) == 24 + 3  # the rim of the sheet, and the fin
    atlas = unwrap(with_fin, np.concatenate([faces, [fin]]).astype(np.int32), Options(), Context())
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
    positions, faces = mesh if seed is None else shapes.shuffled(*mesh, seed)[:2]
    assert sizes_of_bodies(positions, faces) == sorted(bodies)


@pytest.mark.parametrize("seed", [None, 1, 2])
def test_sheets_with_vertices_of_their_own_stay_whole_where_they_lie_on_others(seed):
    positions, faces = shapes.plane(6)
    positions = np.round(6 * positions)
    mirrored = positions * [-1, 1, 1] + [6, 0, 0]  # the same squares with their other diagonals
    mesh = (
        np.concatenate([positions, mirrored]),
        np.concatenate([faces, faces[:, ::-1] + len(positions)]).astype(np.int32),
    )
    positions, faces = mesh if seed is None else shapes.shuffled(*mesh, seed)[:2]
    assert sizes_of_bodies(positions, faces) == [72, 72]


def test_the_two_sides_of_a_face_with_vertices_of_its_own_do_not_meet():
    positions, faces = shapes.plane(6)
    own = np.arange(3) + len(positions)
    mesh = np.concatenate([positions, positions[faces[30]]])
    assert sizes_of_bodies(mesh, np.array([*faces, own, own[::-1]], np.int32)) == [1, 1, 72]


def links_around(apexes, directions):
    """Which of the faces around one edge meet, as a set of pairs."""
    positions = np.array([[0, 0, 0], [1, 0, 0], *apexes], float)
    faces = [[0, 1, 2 + i] if up else [1, 0, 2 + i] for i, up in enumerate(directions)]
    turned = Rotation.random(rng=8).apply(positions)
    found = []
    for p in (positions, turned, turned[:, ::-1] * [1, 1, -1]):
        opposite = _core.Surface(np.ascontiguousarray(p), np.array(faces, np.int32)).opposite
        found.append({frozenset((f, int(h) // 3)) for f, h in enumerate(opposite[:, 0]) if h >= 0})
    assert found[0] == found[1] == found[2]
    return {tuple(sorted(pair)) for pair in found[0]}


def around(*degrees):
    return [[0.5, np.cos(np.radians(d)), np.sin(np.radians(d))] for d in degrees]


def test_solids_that_touch_along_an_edge_are_closed_there():
    # A face that runs from 0 to 1 has the solid at smaller angles behind it.
    assert links_around(around(0, 90, 180, 270), [0, 1, 0, 1]) == {(0, 1), (2, 3)}
    assert links_around(around(0, 90, 180, 270), [1, 0, 1, 0]) == {(0, 3), (1, 2)}
    # The wall at 90 degrees is that of both solids.
    assert links_around(around(0, 90, 90.01, 200), [0, 1, 0, 1]) == {(0, 1), (2, 3)}
    assert links_around(around(0, 90.01, 90, 200), [0, 1, 0, 1]) == {(0, 1), (2, 3)}
    assert links_around(around(90.01, 0, 200, 90), [1, 0, 1, 0]) == {(0, 1), (2, 3)}


def test_a_surface_goes_straight_on_where_others_meet_it():
    assert links_around(around(0, 100, 180), [0, 1, 1]) == {(0, 2)}
    assert links_around(around(0, 90, 170), [0, 0, 1]) == {(0, 2)}
    assert links_around(around(0, 110, 250), [0, 1, 1]) == set()  # both as straight
    assert links_around(around(0, 60, 300), [1, 0, 0]) == set()  # both too sharp
    assert links_around(around(0, 60, 320), [1, 0, 0]) == set()  # too sharp, though one is less so
    assert links_around(around(0, 180, 120, 240), [0, 1, 1, 1]) == {(0, 1)}


def test_thin_faces_at_an_edge_of_many_have_no_direction_and_meet_none():
    thin = [[0.5, 1e-12, 0], [0.3, -1e-12, 0]]
    assert links_around([*thin, *around(90)], [0, 1, 1]) == set()
    # Thicker they go straight on.
    thick = [[0.5, 1e-3, 0], [0.3, -1e-3, 0]]
    assert links_around([*thick, *around(90)], [0, 1, 1]) == {(0, 1)}


def _edges(faces):
    return [(a, b) for t in faces for a, b in zip(t, np.roll(t, -1), strict=True)]
