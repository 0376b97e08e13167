"""Which primitives are to be unwrapped: all, or those of named meshes and materials."""

from __future__ import annotations

from collections.abc import Sequence

from partuv_contract.errors import OptionError

from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.primitives import Primitive

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


def _names(root: Cursor, primitive: Primitive) -> set[str]:
    mesh = root.element("meshes", primitive.mesh)
    owners = [mesh]
    materials = root.length("materials")
    material = mesh.element("primitives", primitive.number).index("material", materials, "material")
    if material is not None:
        owners.append(root.element("materials", material))
    return {name.as_text() for owner in owners if (name := owner.get("name")) is not None}
