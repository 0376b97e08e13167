import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from partuv_engine import EngineError, _core

from tests.support import trees


def same_partition(a, b):
    pairs = set(zip(a.tolist(), b.tolist(), strict=True))
    return len(pairs) == len(set(a.tolist())) == len(set(b.tolist()))


@settings(max_examples=20, deadline=None)
@given(st.integers(1, 5), st.integers(1, 4), st.integers(0, 10**6), st.integers(1, 60))
def test_a_cut_undoes_the_last_merges(columns, rows, seed, parts):
    positions, faces = trees.grid(columns, rows, seed, 1.0)
    surface = _core.Surface(positions, faces)
    tree = _core.build_part_tree(surface)
    labels = np.arange(len(faces))
    for left, right in list(zip(tree.left, tree.right, strict=True))[: max(len(faces) - parts, 0)]:
        members = [tree.order[tree.begin[n] : tree.end[n]] for n in (left, right)]
        labels[np.concatenate(members)] = labels[members[0][0]]
    found = _core.cut_tree(surface, tree, parts)
    assert same_partition(found, labels)
    first_faces = [int(np.argmax(found == part)) for part in range(found.max() + 1)]
    assert first_faces == sorted(first_faces)


def test_a_dumbbell_has_two_parts():
    positions, faces = trees.dumbbell()
    surface = _core.Surface(positions, faces)
    labels = _core.cut_tree_auto(surface, _core.build_part_tree(surface))
    assert labels.max() == 1
    x = positions[faces].mean(axis=1)[:, 0]
    assert same_partition(labels, np.sign(x))


@pytest.mark.parametrize("rotation", range(3))
def test_a_box_is_one_part(rotation):
    corners = np.array(list(itertools.product([0, 1.0], [0, 2.0], [0, 3.0])))
    corners = np.roll(corners, rotation, axis=1)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))], np.int32)
    surface = _core.Surface(corners, faces)
    labels = _core.cut_tree_auto(surface, _core.build_part_tree(surface))
    assert (labels == 0).all()


def test_components_are_parts_unless_they_are_crumbs():
    big = trees.dumbbell()
    crumb_positions, crumb_faces = trees.tetrahedra(30, 0)
    offset = np.array([10.0, 0, 0])
    positions = np.concatenate([big[0], big[0] + offset, crumb_positions * 1e-3 + offset])
    faces = np.concatenate([big[1], big[1] + len(big[0]), crumb_faces + 2 * len(big[0])])
    surface = _core.Surface(positions, np.ascontiguousarray(faces, np.int32))
    labels = _core.cut_tree_auto(surface, _core.build_part_tree(surface))
    count = len(big[1])
    first, second, crumbs = labels[:count], labels[count : 2 * count], labels[2 * count :]
    assert not set(first) & set(second)
    assert set(crumbs) <= set(second)


def test_faces_outside_of_the_surface_go_with_a_neighbour():
    positions, faces = trees.dumbbell()
    collapsed = np.array([[faces[0][0], faces[0][0], faces[0][1]], [5, 5, 5]], np.int32)
    surface = _core.Surface(positions, np.concatenate([collapsed[:1], faces, collapsed[1:]]))
    labels = _core.cut_tree_auto(surface, _core.build_part_tree(surface))
    assert len(labels) == len(faces) + 2
    assert labels[0] == labels[1]
    assert labels[-1] in labels[1:-1][(faces == 5).any(axis=1)]


def test_any_tree_can_be_cut_into_named_parts():
    positions, faces = trees.dumbbell()
    surface = _core.Surface(positions, faces)
    centroids = np.ascontiguousarray(positions[faces].mean(axis=1)[:, :1])
    tree = _core.build_ward_tree(surface, np.sign(centroids))
    assert _core.cut_tree_auto(surface, tree).max() >= 1


def test_a_tree_of_another_mesh_is_refused():
    small, large = (_core.Surface(*trees.grid(n, n, 0, 1.0)) for n in (1, 2))
    with pytest.raises(EngineError, match="tree of 2 faces, surface of 8"):
        _core.cut_tree(large, _core.build_part_tree(small), 2)
    with pytest.raises(EngineError, match="option parts"):
        _core.cut_tree(small, _core.build_part_tree(small), 0)
