import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from partuv_engine import EngineError, _core

from tests.support import trees
from tests.unit.engine.test_tree import assert_valid, merges


def random_nodes(faces, seed):
    """A random merge tree as rows of (id, left, right)."""
    rng = np.random.default_rng(seed)
    alive, rows = list(range(faces)), []
    for node in range(faces, 2 * faces - 1):
        left, right = (alive.pop(rng.integers(len(alive))) for _ in range(2))
        rows.append((node, left, right))
        alive.append(node)
    return np.array(rows, np.int64).reshape(-1, 3)


def tree_file(nodes, count=None):
    rows = [int(value) for row in nodes for value in row]
    return struct.pack(f"<{1 + len(rows)}i", len(nodes) if count is None else count, *rows)


@settings(deadline=None)
@given(st.integers(1, 40), st.integers(0, 10**6))
def test_a_tree_comes_back_as_it_was_given_in_whatever_order(faces, seed):
    nodes = random_nodes(faces, seed)
    shuffled = np.random.default_rng(seed).permutation(nodes)
    for tree in (
        _core.import_tree(faces, shuffled),
        _core.read_tree_file(faces, tree_file(shuffled)),
    ):
        assert_valid(tree)
        assert merges(tree) == [tuple(row) for row in nodes[:, 1:].tolist()]


def broken(change):
    nodes = random_nodes(6, 0)
    change(nodes)
    return nodes


@pytest.mark.parametrize(
    ("nodes", "where"),
    [
        (random_nodes(6, 0)[:-1], "4 merges, expected 5 for 6 faces"),
        (random_nodes(7, 0), "6 merges, expected 5 for 6 faces"),
        ([[6, 0, 1], [7, 2, 3], [8, 4, 5], [9, 6, 7], [11, 8, 9]], "node 11: merges are numbered"),
        ([[6, 0, 1], [7, 2, 3], [8, 4, 5], [9, 6, 7], [5, 8, 9]], "node 5: merges are numbered"),
        ([[6, 0, 1], [7, 2, 3], [8, 4, 5], [9, 6, 7], [9, 8, 9]], "node 9: given twice"),
        ([[6, 0, 7], [7, 2, 6], [8, 4, 5], [9, 1, 3], [10, 8, 9]], "node 6: child 7 is neither"),
        ([[6, 0, 1], [7, 2, 7], [8, 4, 5], [9, 6, 3], [10, 8, 9]], "node 7: child 7 is neither"),
        ([[6, 0, 1], [7, 2, -3], [8, 4, 5], [9, 6, 3], [10, 8, 9]], "node 7: child -3 is neither"),
        ([[6, 0, 1], [7, 2, 1], [8, 4, 5], [9, 6, 3], [10, 8, 9]], "node 1: child of two merges"),
        ([[6, 0, 0], [7, 2, 1], [8, 4, 5], [9, 6, 3], [10, 8, 9]], "node 0: child of two merges"),
        (
            [[2**40, 0, 1], [7, 2, 3], [8, 4, 5], [9, 6, 7], [10, 8, 9]],
            "node 1099511627776: merges",
        ),
    ],
)
def test_what_is_no_tree_is_refused_by_name(nodes, where):
    with pytest.raises(EngineError) as caught:
        _core.import_tree(6, np.array(nodes, np.int64))
    assert caught.value.code == "invalid_tree"
    assert caught.value.where.startswith(where)


@pytest.mark.parametrize(
    ("file", "where"),
    [
        (b"", "tree file: no header"),
        (b"\5\0\0", "tree file: no header"),
        (tree_file(random_nodes(5, 0)), "tree file: 4 merges, expected 5 for 6 faces"),
        (tree_file([], count=2**31 - 1), "tree file: 2147483647 merges, expected 5"),
        (tree_file([], count=-1), "tree file: -1 merges, expected 5 for 6 faces"),
        (tree_file([], count=5), "tree file: 4 bytes, expected 64"),
        (tree_file(random_nodes(6, 0))[:-1], "tree file: 63 bytes, expected 64"),
        (tree_file(random_nodes(6, 0)) + b"\0", "tree file: 65 bytes, expected 64"),
        (tree_file(random_nodes(6, 0) * [1, 1, -1]), "node 6: child -"),
    ],
)
def test_a_damaged_file_is_refused_by_name(file, where):
    with pytest.raises(EngineError) as caught:
        _core.read_tree_file(6, file)
    assert caught.value.code == "invalid_tree"
    assert caught.value.where.startswith(where)


def test_a_tree_of_no_faces_is_refused():
    with pytest.raises(EngineError, match="tree of no faces"):
        _core.import_tree(0, np.zeros((0, 3), np.int64))


@settings(deadline=None)
@given(st.integers(1, 30), st.integers(0, 10**6), st.data())
def test_a_restricted_tree_keeps_who_meets_whom_first(faces, seed, data):
    tree = _core.import_tree(faces, random_nodes(faces, seed))
    kept = data.draw(st.permutations(range(faces)))[: data.draw(st.integers(1, faces))]
    small = tree.restrict(np.array(kept, np.int32))
    assert_valid(small)

    def nodes_of(tree, names):
        nodes = [
            frozenset(tree.order[tree.begin[n] : tree.end[n]].tolist())
            for n in range(2 * tree.face_count - 1)
        ]
        return [frozenset(names[f] for f in node if f in names) for node in nodes]

    expected = nodes_of(tree, {f: f for f in kept})
    found = nodes_of(small, dict(enumerate(kept)))
    assert set(found) == set(expected) - {frozenset()}


@pytest.mark.parametrize("representatives", [[0, 4], [-1, 2], [2, 2]])
def test_representatives_must_be_faces_and_differ(representatives):
    tree = _core.import_tree(4, random_nodes(4, 0))
    with pytest.raises(EngineError, match="is no face of its own"):
        tree.restrict(np.array(representatives, np.int32))


def test_the_official_tree_of_the_golden_mesh_is_read(partfield_golden):
    nodes = np.column_stack([partfield_golden["pu_tree_id"], partfield_golden["pu_tree_children"]])
    faces = len(partfield_golden["mesh_f"])
    tree = _core.read_tree_file(faces, partfield_golden["pu_tree_bin"].tobytes())
    assert merges(tree) == merges(_core.import_tree(faces, nodes.astype(np.int64)))


@pytest.fixture
def partfield_golden():
    path = trees.SHARED / "partfield" / "golden.npz"
    if not path.exists():
        pytest.skip("golden data of the part network is not at hand")
    return np.load(path)
