"""Reading the UVs that an asset has already."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import UnusableUvError

from partuv_worker.glb.accessors import UNSIGNED_INT, Accessors
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.soup import Piece, TriangleSoup

_SET = "TEXCOORD_0"


def read_corner_uv(soup: TriangleSoup, accessors: Accessors) -> NDArray[np.float64]:
    """The first UV set at the corners of a soup (F x 3 x 2), V up: from 0 downwards."""
    uv = np.concatenate([_of_piece(piece, accessors) for piece in soup.pieces])
    uv[..., 1] *= -1  # exact, as 1 - V would not be: corners are compared
    return uv


def _of_piece(piece: Piece, accessors: Accessors) -> NDArray[np.float64]:
    primitive = piece.primitive
    name = f"primitive {primitive.number} of mesh {primitive.mesh}"
    index = primitive.attributes.get(_SET)
    if index is None:
        raise UnusableUvError(
            f"{name} has no {_SET} to keep: unwrap it, or choose others with `only`",
            pointer=primitive.pointer,
        )
    accessor = accessors.describe(index)
    if accessor.kind != "VEC2" or accessor.component_type == UNSIGNED_INT:
        Cursor(None, accessor.pointer).fail("UVs that are not vectors of two numbers")
    uv = accessors.numbers(index)[piece.triangles]
    if not np.isfinite(uv).all():
        face = int(np.flatnonzero(~np.isfinite(uv).all(axis=(1, 2)))[0])
        vertices = ", ".join(map(str, piece.triangles[face]))
        raise UnusableUvError(
            f"{name} has a {_SET} that is NaN or infinite, at one of the vertices {vertices}",
            pointer=primitive.pointer,
        )
    return np.ascontiguousarray(uv[:, ::-1]) if piece.mirrored else uv
