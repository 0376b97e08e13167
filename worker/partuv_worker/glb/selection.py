"""What names choose: the primitives to be unwrapped, and how many texels a material gets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import OptionError

from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.primitives import Primitive
from partuv_worker.glb.soup import Piece

_SHOWN = 20  # names listed when one is not found


def select(root: Cursor, primitives: Sequence[Primitive], only: Sequence[str]) -> list[Primitive]:
    """The primitives whose mesh or material has one of these names; all if there are no names."""
    if not only:
        return list(primitives)
    chosen = []
    seen: set[str] = set()
    for primitive in primitives:
        names = _names(root, primitive)
        seen |= names
        if not names.isdisjoint(only):
            chosen.append(primitive)
    missing = [name for name in only if name not in seen]
    if missing:
        known = ", ".join(repr(name) for name in sorted(seen)[:_SHOWN]) or "none has a name"
        raise OptionError(
            f"no mesh or material is named {missing[0]!r}; there are: {known}", pointer="/only"
        )
    return chosen


def face_weights(
    root: Cursor, pieces: Sequence[Piece], weights: Mapping[str, float]
) -> NDArray[np.float64] | None:
    """The weight of each face of a soup, by the name of its material; none if there are none."""
    if not weights:
        return None
    names = [_name(_material(root, piece.primitive)) for piece in pieces]
    missing = [name for name in weights if name not in names]
    if missing:
        shown = sorted({name for name in names if name is not None})[:_SHOWN]
        known = ", ".join(map(repr, shown)) or "none has a name"
        raise OptionError(
            f"texel_weights: no material is named {missing[0]!r}; there are: {known}",
            pointer="/texel_weights",
        )
    of_piece = [1.0 if name is None else weights.get(name, 1.0) for name in names]
    return np.repeat(of_piece, [len(piece.triangles) for piece in pieces])


def _names(root: Cursor, primitive: Primitive) -> set[str]:
    owners = (root.element("meshes", primitive.mesh), _material(root, primitive))
    return {name for owner in owners if (name := _name(owner)) is not None}


def _material(root: Cursor, primitive: Primitive) -> Cursor | None:
    own = root.element("meshes", primitive.mesh).element("primitives", primitive.number)
    number = own.index("material", root.length("materials"), "material")
    return None if number is None else root.element("materials", number)


def _name(owner: Cursor | None) -> str | None:
    name = None if owner is None else owner.get("name")
    return None if name is None else name.as_text()
