"""Steps that can be left out do something, and no bound depends on them."""

import numpy as np
import pytest
from partuv_engine import Ablation, Atlas, Context, Options, unwrap

from tests.support import shapes
from tests.support.atlas import assert_sound


def without(mesh, **changed) -> Atlas:
    ablation = Ablation()
    for name, value in changed.items():
        setattr(ablation, name, value)
    return unwrap(*mesh, Options(), Context(), ablation=ablation)


def charts(atlas: Atlas) -> int:
    return len(atlas.charts["faces"])


@pytest.mark.parametrize(
    ("name", "mesh"),
    [
        ("cut_open", shapes.cube(2)),
        ("merge_heuristic", shapes.torus(24, 12)),
        ("polish", shapes.icosphere(3)),
        ("final_merge", shapes.icosphere(3)),
    ],
)
def test_bounds_hold_without_a_step(name, mesh):
    atlas = without(mesh, **{name: False})
    assert_sound(*mesh, atlas, min_gutter_uv=4 / 1024)
    assert charts(atlas) >= charts(without(mesh))


@pytest.mark.parametrize("seed", [3, 5])
def test_searching_below_accepted_nodes_helps_where_nothing_is_merged_afterwards(seed):
    mesh = shapes.blocks(np.random.default_rng(seed).random((3, 3, 3)) < 0.6)
    merged_by_none = {"final_merge": False, "merge_heuristic": False}
    atlas = without(mesh, recursion=True, **merged_by_none)
    assert_sound(*mesh, atlas, min_gutter_uv=4 / 1024)
    assert charts(atlas) < charts(without(mesh, **merged_by_none))


def test_a_closed_cube_that_may_not_be_cut_open_is_split():
    assert charts(without(shapes.cube(2), cut_open=False)) > 1


def test_fixed_parts_are_charts_of_their_own_unless_they_are_merged():
    mesh = shapes.torus(24, 12)
    assert charts(without(mesh, fixed_parts=8, final_merge=False)) >= 8
    assert charts(without(mesh, final_merge=False)) < 8


def test_without_proxy_the_search_sees_every_face():
    mesh = shapes.torus(120, 60)
    assert without(mesh).proxy_faces < len(mesh[1])
    assert without(mesh, proxy=False).proxy_faces == len(mesh[1])
