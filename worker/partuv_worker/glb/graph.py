"""The node graph: where the meshes stand in the world (glTF 2.0, section 3.5)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import LimitError

from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.limits import Limits

Matrix = NDArray[np.float64]


@dataclass
class Graph:
    """Every mesh that a scene draws, with its places; the default scene's come first."""

    places: dict[int, list[Matrix]] = field(default_factory=dict)  # mesh -> world transforms


def read_graph(root: Cursor, limits: Limits) -> Graph:
    """Walk all scenes; refuses cycles, nodes with two parents and graphs beyond the limits."""
    nodes = root.elements("nodes")
    if len(nodes) > limits.nodes:
        raise LimitError(
            f"{len(nodes)} nodes, at most {limits.nodes} are allowed", pointer="/nodes"
        )
    children, is_child = _edges(nodes)
    graph = Graph()
    visited = [False] * len(nodes)
    mesh_count = root.length("meshes")
    for roots in _scene_roots(root, nodes, is_child):
        _walk(nodes, children, roots, visited, mesh_count, graph, limits)
    return graph


def _walk(
    nodes: list[Cursor],
    children: list[list[int]],
    roots: list[int],
    visited: list[bool],
    mesh_count: int,
    graph: Graph,
    limits: Limits,
) -> None:
    """Depth first in the order of the file. A None matrix is the identity."""
    stack: list[tuple[int, Matrix | None, int]] = [(node, None, 1) for node in reversed(roots)]
    while stack:
        index, parent, depth = stack.pop()
        if visited[index]:  # a root that two scenes share; a node below it has one parent only
            continue
        visited[index] = True
        node = nodes[index]
        if depth > limits.node_depth:
            raise LimitError(f"nodes nest deeper than {limits.node_depth}", pointer=node.pointer)
        local = _local_matrix(node)
        world = _product(parent, local)
        if world is not None and not np.isfinite(world).all():
            node.fail("its transform, with those above it, goes beyond all bounds")
        mesh = node.index("mesh", mesh_count, "mesh")
        if mesh is not None:
            graph.places.setdefault(mesh, []).append(np.eye(4) if world is None else world)
        stack.extend((child, world, depth + 1) for child in reversed(children[index]))


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
