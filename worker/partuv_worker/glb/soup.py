"""All triangles of a scene as one indexed mesh, with the way back to their primitives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import LimitError, MalformedGlbError, NoTrianglesError

from partuv_worker.glb.accessors import Accessors
from partuv_worker.glb.graph import Graph, Matrix
from partuv_worker.glb.limits import Limits
from partuv_worker.glb.primitives import (
    TRIANGLE_MODES,
    TRIANGLES,
    Primitive,
    read_positions,
    read_triangles,
)


@dataclass(frozen=True)
class Piece:
    """The triangles of one primitive within the soup."""

    primitive: Primitive
    triangles: NDArray[np.int64]  # n x 3, vertex numbers of the primitive, in the file's winding
    first_face: int
    mirrored: bool  # its transform turns faces inside out, so the soup has them reversed

    def corner_uv(self, of_soup: NDArray[Any]) -> NDArray[Any]:
        """The rows of this piece (n x 3 x ...) of a per-corner array of the whole soup."""
        own = of_soup[self.first_face : self.first_face + len(self.triangles)]
        return own[:, ::-1] if self.mirrored else own


@dataclass(frozen=True)
class TriangleSoup:
    """One mesh in world space: what the engine unwraps."""

    positions: NDArray[np.float64]  # V x 3
    faces: NDArray[np.int32]  # F x 3, counter-clockwise from outside
    pieces: Sequence[Piece]

    def by_mesh(self) -> list[TriangleSoup]:
        """One soup per mesh, in order; together they have the same faces."""
        first_of_mesh = [
            piece.first_face
            for previous, piece in zip((None, *self.pieces), self.pieces, strict=False)
            if previous is None or previous.primitive.mesh != piece.primitive.mesh
        ]
        ends = [*first_of_mesh[1:], len(self.faces)]
        return [self._slice(start, end) for start, end in zip(first_of_mesh, ends, strict=True)]

    def _slice(self, start: int, end: int) -> TriangleSoup:
        faces = self.faces[start:end]
        low, high = int(faces.min()), int(faces.max()) + 1
        pieces = [piece for piece in self.pieces if start <= piece.first_face < end]
        return TriangleSoup(self.positions[low:high], faces - np.int32(low), pieces)


def gather_soup(
    primitives: Sequence[Primitive], graph: Graph, accessors: Accessors, limits: Limits
) -> TriangleSoup:
    """Collect the triangles of these primitives, each where its mesh stands first."""
    drawn = [
        primitive
        for primitive in primitives
        if primitive.mode in TRIANGLE_MODES and "POSITION" in primitive.attributes
    ]
    _check_budget(drawn, accessors, limits)
    positions, faces, pieces = [], [], []
    vertex_count = face_count = 0
    for primitive in drawn:
        triangles = read_triangles(primitive, accessors)
        if not len(triangles):
            continue
        place = _first_regular(graph.places[primitive.mesh])
        used, local = _used_vertices(triangles, accessors.describe(primitive.position).count)
        points = _transformed(read_positions(primitive, accessors)[used], place, primitive)
        mirrored = _orientation(place) < 0
        pieces.append(Piece(primitive, triangles, face_count, mirrored))
        positions.append(points)
        faces.append((local[:, ::-1] if mirrored else local) + vertex_count)
        vertex_count += len(points)
        face_count += len(triangles)
    if not pieces:
        raise NoTrianglesError("the scene has no triangles")
    return TriangleSoup(
        np.concatenate(positions), np.concatenate(faces).astype(np.int32), tuple(pieces)
    )


def _check_budget(primitives: Sequence[Primitive], accessors: Accessors, limits: Limits) -> None:
    """Count before anything is read: primitives may draw the same few bytes over and over."""
    vertices = faces = 0
    for primitive in primitives:
        vertices += accessors.describe(primitive.position).count
        drawn = primitive.position if primitive.indices is None else primitive.indices
        corners = accessors.describe(drawn).count
        faces += corners // 3 if primitive.mode == TRIANGLES else max(corners - 2, 0)
        if vertices > limits.vertices or faces > limits.faces:
            raise LimitError(
                f"more than {limits.vertices} vertices or {limits.faces} triangles",
                pointer=primitive.pointer,
            )


def _used_vertices(
    triangles: NDArray[np.int64], vertex_count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """The vertices that triangles use, ascending, and the triangles in terms of them."""
    is_used = np.zeros(vertex_count, bool)
    is_used[triangles] = True
    return np.flatnonzero(is_used), (np.cumsum(is_used) - 1)[triangles]


def _first_regular(places: Sequence[Matrix]) -> Matrix:
    """The first transform that does not flatten the mesh; none of them: its own space."""
    return next((place for place in places if _orientation(place)), np.eye(4))


def _orientation(place: Matrix) -> float:
    """Positive, or negative for a mirroring transform; 0 if it flattens space."""
    linear = place[:3, :3]
    return float(np.linalg.det(linear / (np.abs(linear).max() or 1.0)))


def _transformed(
    points: NDArray[np.float64], place: Matrix, primitive: Primitive
) -> NDArray[np.float64]:
    """Points in world space. Equal points stay equal: every row is computed the same way, which a
    matrix product of the BLAS does not promise."""
    if np.array_equal(place, np.eye(4)):
        return points
    x, y, z = points.T
    with np.errstate(over="ignore", invalid="ignore"):
        world = np.stack(
            [x * row[0] + y * row[1] + z * row[2] + row[3] for row in place[:3]], axis=1
        )
    if not np.isfinite(world).all():
        raise MalformedGlbError(
            "the node transforms carry positions beyond all bounds", pointer=primitive.pointer
        )
    return world
