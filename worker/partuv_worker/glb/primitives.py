"""Primitives: what is drawn, and the triangles of it (glTF 2.0, section 3.7.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import LimitError, NonFinitePositionError

from partuv_worker.glb.accessors import (
    UNSIGNED_BYTE,
    UNSIGNED_INT,
    UNSIGNED_SHORT,
    Accessors,
)
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.limits import Limits

POINTS, LINES, LINE_LOOP, LINE_STRIP, TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN = range(7)
TRIANGLE_MODES = (TRIANGLES, TRIANGLE_STRIP, TRIANGLE_FAN)


@dataclass(frozen=True)
class Primitive:
    """One primitive of a mesh, its references checked."""

    mesh: int
    number: int  # within the mesh
    pointer: str
    mode: int
    attributes: dict[str, int]  # name -> accessor
    targets: tuple[dict[str, int], ...]  # morph targets: name -> accessor
    indices: int | None

    @property
    def position(self) -> int:
        """The accessor of the positions."""
        return self.attributes["POSITION"]

    def vertex_accessors(self) -> set[int]:
        """All accessors with one element per vertex."""
        found = set(self.attributes.values())
        return found.union(*(target.values() for target in self.targets))


def list_primitives(root: Cursor, accessors: Accessors, limits: Limits) -> list[list[Primitive]]:
    """The primitives of each mesh, of every mode, also of meshes that no scene draws."""
    count = 0
    found = []
    for mesh, owner in enumerate(root.elements("meshes")):
        cursors = owner.elements("primitives")
        if not cursors:
            owner.fail("a mesh without primitives")
        count += len(cursors)
        if count > limits.primitives:
            raise LimitError(f"more than {limits.primitives} primitives", pointer=owner.pointer)
        found.append([_check(mesh, number, c, accessors) for number, c in enumerate(cursors)])
    return found


def read_positions(primitive: Primitive, accessors: Accessors) -> NDArray[np.float64]:
    """Positions (count x 3) in the mesh's own space; refuses NaN and infinity."""
    values = accessors.numbers(primitive.position)
    if not np.isfinite(values).all():
        vertex = int(np.flatnonzero(~np.isfinite(values).all(axis=1))[0])
        raise NonFinitePositionError(
            f"accessor {primitive.position}: the position of vertex {vertex} is NaN or infinite",
            pointer=accessors.describe(primitive.position).pointer,
        )
    return values


def read_triangles(primitive: Primitive, accessors: Accessors) -> NDArray[np.int64]:
    """Vertex indices (F x 3) in the file's winding; strips and fans are unrolled."""
    vertex_count = accessors.describe(primitive.position).count
    if primitive.indices is None:
        corners = np.arange(vertex_count, dtype=np.int64)
    else:
        corners = accessors.values(primitive.indices).ravel().astype(np.int64)
        if corners.max() >= vertex_count:
            place = int(np.argmax(corners >= vertex_count))
            Cursor(None, accessors.describe(primitive.indices).pointer).fail(
                f"index {place} is {corners[place]}, there are {vertex_count} vertices"
            )
    if primitive.mode == TRIANGLES:
        return corners[: len(corners) // 3 * 3].reshape(-1, 3)
    if len(corners) < 3:
        return np.empty((0, 3), np.int64)
    if primitive.mode == TRIANGLE_FAN:
        rim = corners[1:]
        return np.stack([rim[:-1], rim[1:], np.broadcast_to(corners[0], len(rim) - 1)], axis=1)
    triangles = np.stack([corners[:-2], corners[1:-1], corners[2:]], axis=1)
    triangles[1::2, 1:] = triangles[1::2, :0:-1]
    return triangles


def _check(mesh: int, number: int, cursor: Cursor, accessors: Accessors) -> Primitive:
    primitive = Primitive(
        mesh=mesh,
        number=number,
        pointer=cursor.pointer,
        mode=cursor.integer("mode", TRIANGLES, POINTS, TRIANGLE_FAN),
        attributes=_references(cursor.need("attributes"), accessors),
        targets=tuple(_references(target, accessors) for target in cursor.elements("targets")),
        indices=cursor.index("indices", len(accessors), "accessor"),
    )
    if primitive.mode in TRIANGLE_MODES and "POSITION" in primitive.attributes:
        _check_accessors(primitive, cursor, accessors)
    return primitive


def _references(owner: Cursor, accessors: Accessors) -> dict[str, int]:
    found = {name: cursor.as_index(len(accessors), "accessor") for name, cursor in owner.items()}
    for index in found.values():
        accessors.describe(index)
    return found


def _check_accessors(primitive: Primitive, cursor: Cursor, accessors: Accessors) -> None:
    position = accessors.describe(primitive.position)
    if position.kind != "VEC3" or position.component_type == UNSIGNED_INT:
        Cursor(None, position.pointer).fail("positions that are not vectors of three numbers")
    for index in primitive.vertex_accessors():
        accessor = accessors.describe(index)
        if accessor.count != position.count:
            Cursor(None, accessor.pointer).fail(
                f"{accessor.count} elements, but the primitive {primitive.pointer} "
                f"has {position.count} positions"
            )
        accessors.check_bytes(index)
    if primitive.indices is None:
        return
    indices = accessors.describe(primitive.indices)
    allowed = (UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT)
    if indices.kind != "SCALAR" or indices.component_type not in allowed or indices.normalized:
        Cursor(None, indices.pointer).fail("indices that are not unsigned integers")
