import numpy as np
import pytest
from partuv_contract.errors import LimitError, MalformedGlbError
from partuv_worker.glb.accessors import Accessors
from partuv_worker.glb.buffers import Buffers
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.graph import read_graph
from partuv_worker.glb.limits import Limits


def graph(nodes, scenes=None, scene=None, meshes=4, limits=None, more=None, binary=b""):
    document = {"nodes": nodes, "meshes": [{}] * meshes}
    document |= {"scenes": scenes} if scenes is not None else {}
    document |= {"scene": scene} if scene is not None else {}
    root = Cursor(document | (more or {}), "")
    limits = limits or Limits()
    buffers = Buffers(root, memoryview(binary), limits)
    return read_graph(root, Accessors(root, buffers, limits), limits).places


def test_transforms_are_applied_from_the_root_down():
    half_turn_about_z = [0, 0, 1, 0]
    nodes = [
        {"children": [1], "translation": [10, 0, 0], "rotation": half_turn_about_z},
        {"mesh": 2, "translation": [1, 2, 3], "scale": [1, 2, -3]},
    ]
    (place,) = graph(nodes)[2]
    assert place @ [1, 1, 1, 1] == pytest.approx([10 - 2, -4, 0, 1])


def test_a_matrix_is_read_by_columns():
    (place,) = graph([{"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1]}])[0]
    assert place[:3, 3].tolist() == [5, 6, 7]


def test_the_default_scene_comes_first_and_every_scene_counts():
    nodes = [{"mesh": 0}, {"mesh": 1}, {"mesh": 2}, {"mesh": 3}]
    scenes = [{"nodes": [0]}, {"nodes": [1, 0]}]
    assert list(graph(nodes, scenes, 1)) == [1, 0]
    assert list(graph(nodes, scenes)) == [0, 1]
    assert list(graph(nodes)) == [0, 1, 2, 3]


def test_all_places_of_a_mesh_are_found_in_the_order_of_the_file():
    nodes = [
        {"children": [1, 2]},
        {"mesh": 0, "translation": [1, 0, 0]},
        {"mesh": 0, "translation": [2, 0, 0]},
    ]
    assert [place[0, 3] for place in graph(nodes)[0]] == [1, 2]


def test_equal_transforms_give_equal_bits():
    rotation = (np.array([1, 2, 3, 4]) / np.sqrt(30)).tolist()
    nodes = [
        {"children": [k + 1], "rotation": rotation, "scale": [0.3, 0.7, 1.1]} for k in range(9)
    ]
    nodes = [*nodes, {"mesh": 0, "rotation": rotation}]
    first, second = graph(nodes)[0][0], graph(nodes)[0][0]
    assert first.tobytes() == second.tobytes()


@pytest.mark.parametrize(
    "nodes",
    [
        [{"children": [0]}],
        [{"children": [1]}, {"children": [2]}, {"children": [1]}],
        [{"children": [1]}, {"children": [0]}, {"mesh": 0}],
        [{"children": [1, 1]}, {"mesh": 0}],
        [{"children": [2]}, {"children": [2]}, {"mesh": 0}],
        [{"children": [7]}],
        [{"mesh": 99}],
        [{"mesh": -1}],
        [{"mesh": 0, "scale": [1, 2]}],
        [{"mesh": 0, "translation": "here"}],
        [{"mesh": 0, "matrix": [1] * 15}],
        [{"children": 3}],
        ["node"],
    ],
)
def test_refuses_graphs_that_are_no_forest(nodes):
    with pytest.raises(MalformedGlbError) as caught:
        graph(nodes)
    assert caught.value.pointer.startswith("/nodes")


def test_bounds_depth_and_number():
    chain = [{"children": [k + 1]} for k in range(50)] + [{"mesh": 0}]
    assert graph(chain, limits=Limits(node_depth=51))
    with pytest.raises(LimitError):
        graph(chain, limits=Limits(node_depth=50))
    with pytest.raises(LimitError):
        graph(chain, limits=Limits(nodes=50))


def test_a_skinned_mesh_stands_where_its_first_joint_carries_it():
    bind = np.diag([0.5, 0.5, 0.5, 1.0])
    bind[:3, 3] = [1, 0, 0]
    binary = bind.T.astype("<f4").tobytes()
    more = {
        "skins": [{"joints": [1, 0], "inverseBindMatrices": 0}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 1, "type": "MAT4"}],
        "bufferViews": [{"buffer": 0, "byteLength": 64}],
        "buffers": [{"byteLength": 64}],
    }
    nodes = [{"mesh": 0, "skin": 0, "scale": [9, 9, 9]}, {"translation": [0, 5, 0]}]
    (place,) = graph(nodes, more=more, binary=binary)[0]
    assert place @ [2, 2, 2, 1] == pytest.approx([2, 6, 1, 1])
    more["skins"][0].pop("inverseBindMatrices")
    (place,) = graph(nodes, more=more, binary=binary)[0]
    assert place @ [2, 2, 2, 1] == pytest.approx([2, 7, 2, 1])


@pytest.mark.parametrize("skin", [{"joints": []}, {"joints": [7]}, {}])
def test_refuses_skins_without_joints(skin):
    with pytest.raises(MalformedGlbError):
        graph([{"mesh": 0, "skin": 0}], more={"skins": [skin]})
