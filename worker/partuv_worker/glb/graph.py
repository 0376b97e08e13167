"""The node graph: where the meshes stand in the world (glTF 2.0, section 3.5)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import LimitError

from partuv_worker.glb.accessors import FLOAT, Accessors
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.limits import Limits

Matrix = NDArray[np.float64]


@dataclass
class Graph:
    """Every mesh that a scene draws, with its places; the default scene's come first."""

    places: dict[int, list[Matrix]] = field(default_factory=dict)  # mesh -> world transforms


def read_graph(root: Cursor, accessors: Accessors, limits: Limits) -> Graph:
    """Walk all scenes; refuses cycles, nodes with two parents and graphs beyond the limits.

    A skinned mesh stands where its first joint carries it, as the specification says (3.7.3.3).
    """
    nodes = root.elements("nodes")
    if len(nodes) > limits.nodes:
        raise LimitError(
            f"{len(nodes)} nodes, at most {limits.nodes} are allowed", pointer="/nodes"
        )
    children, is_child = _edges(nodes)
    worlds: dict[int, Matrix | None] = {}
    for roots in _scene_roots(root, nodes, is_child):
        _walk(nodes, children, roots, worlds, limits)
    graph = Graph()
    mesh_count = root.length("meshes")
    for index, world in worlds.items():
        mesh = nodes[index].index("mesh", mesh_count, "mesh")
        if mesh is not None:
            place = _skinned(root, nodes[index], worlds, accessors)
            place = place if place is not None else world
            graph.places.setdefault(mesh, []).append(np.eye(4) if place is None else place)
    return graph


def _walk(
    nodes: list[Cursor],
    children: list[list[int]],
    roots: list[int],
    worlds: dict[int, Matrix | None],
    limits: Limits,
) -> None:
    """Find the world transforms, depth first in the order of the file; None is the identity."""
    stack: list[tuple[int, Matrix | None, int]] = [(node, None, 1) for node in reversed(roots)]
    while stack:
        index, parent, depth = stack.pop()
        if index in worlds:  # a root that two scenes share; a node below it has one parent only
            continue
        node = nodes[index]
        if depth > limits.node_depth:
            raise LimitError(f"nodes nest deeper than {limits.node_depth}", pointer=node.pointer)
        local = _local_matrix(node)
        world = _product(parent, local)
        if world is not None and not np.isfinite(world).all():
            node.fail("its transform, with those above it, goes beyond all bounds")
        worlds[index] = world
        stack.extend((child, world, depth + 1) for child in reversed(children[index]))


def _skinned(
    root: Cursor, node: Cursor, worlds: dict[int, Matrix | None], accessors: Accessors
) -> Matrix | None:
    """Where the first joint of a node's skin carries its mesh; None if there is no telling."""
    number = node.index("skin", root.length("skins"), "skin")
    if number is None:
        return None
    skin = root.element("skins", number)
    joints = skin.elements("joints")
    if not joints:
        skin.fail("a skin without joints")
    joint = joints[0].as_index(root.length("nodes"), "node")
    inverse = skin.index("inverseBindMatrices", len(accessors), "accessor")
    if joint not in worlds or inverse is None:
        return worlds.get(joint)
    described = accessors.describe(inverse)
    rows = accessors.base_rows(inverse)
    if described.kind != "MAT4" or described.component_type != FLOAT or rows is None:
        return worlds[joint]
    bind = np.frombuffer(rows[0].tobytes(), "<f4").reshape(4, 4).T.astype(np.float64)
    place = _product(worlds[joint], bind)
    return place if place is not None and np.isfinite(place).all() else worlds[joint]


def _edges(nodes: list[Cursor]) -> tuple[list[list[int]], list[bool]]:
    """Children of every node, and whether it is a child. No node may have two parents."""
    is_child = [False] * len(nodes)
    children = []
    for node in nodes:
        below = []
        for cursor in node.elements("children"):
            child = cursor.as_index(len(nodes), "node")
            if is_child[child]:
                cursor.fail(f"node {child} has two parents")
            is_child[child] = True
            below.append(child)
        children.append(below)
    _refuse_cycles(nodes, children, is_child)
    return children, is_child


def _refuse_cycles(nodes: list[Cursor], children: list[list[int]], is_child: list[bool]) -> None:
    """With one parent each, the nodes that no root reaches are those on cycles and below them."""
    reached = [not child for child in is_child]
    stack = [index for index, is_root in enumerate(reached) if is_root]
    while stack:
        below = children[stack.pop()]
        for child in below:
            reached[child] = True
        stack.extend(below)
    if not all(reached):
        nodes[reached.index(False)].fail("the node is its own ancestor")


def _scene_roots(root: Cursor, nodes: list[Cursor], is_child: list[bool]) -> list[list[int]]:
    """The root nodes of each scene, the default scene first; of all nodes if there is no scene."""
    scenes = root.elements("scenes")
    if not scenes:
        return [[index for index, child in enumerate(is_child) if not child]]
    default = root.index("scene", len(scenes), "scene") or 0
    ordered = [scenes[default], *scenes[:default], *scenes[default + 1 :]]
    return [
        [cursor.as_index(len(nodes), "node") for cursor in scene.elements("nodes")]
        for scene in ordered
    ]


def _local_matrix(node: Cursor) -> Matrix | None:
    """A node's transform, or None for the identity."""
    columns = node.numbers("matrix", 16)
    if columns is not None:
        return np.array(columns).reshape(4, 4).T
    translation = node.numbers("translation", 3)
    rotation = node.numbers("rotation", 4)
    scale = node.numbers("scale", 3)
    if translation is None and rotation is None and scale is None:
        return None
    matrix = np.eye(4)
    if rotation is not None:
        x, y, z, w = rotation
        matrix[:3, :3] = [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    if scale is not None:
        matrix[:3, :3] *= scale
    if translation is not None:
        matrix[:3, 3] = translation
    return matrix


def _product(left: Matrix | None, right: Matrix | None) -> Matrix | None:
    """left @ right, summed in a fixed order, so that every machine gets the same bits."""
    if left is None or right is None:
        return left if right is None else right
    with np.errstate(over="ignore", invalid="ignore"):
        product: Matrix = left[:, 0:1] * right[0]
        for k in range(1, 4):
            product = product + left[:, k : k + 1] * right[k]
    return product
