"""Where the new UV set goes, and what follows the old ones: names and texture references."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable
from typing import Any

from partuv_worker.glb.draft import Draft, Json
from partuv_worker.glb.extensions import TEXTURE_TRANSFORM, VARIANTS

_SET_NAME = re.compile(r"TEXCOORD_(\d+)")


def first_free_set(attributes: Json) -> str:
    """The name of the lowest UV set that a primitive does not have."""
    number = 0
    while f"TEXCOORD_{number}" in attributes:
        number += 1
    return f"TEXCOORD_{number}"


def shift_sets(draft: Draft, primitives: Iterable[tuple[int, int]]) -> None:
    """Move every UV set of these primitives (mesh, number) up by one, with all that refers to it.

    A material that other primitives use as well is copied for these.
    """
    chosen = set(primitives)
    ours: dict[int, list[Json]] = {}
    others: set[int] = set()
    for mesh, owner in enumerate(draft.root.get("meshes", [])):
        for number, primitive in enumerate(owner["primitives"]):
            if (mesh, number) in chosen:
                _shift_names(primitive)
                _shift_texture_infos(primitive.get("extensions", {}))
                for holder in _material_holders(primitive):
                    ours.setdefault(holder["material"], []).append(holder)
            else:
                others.update(holder["material"] for holder in _material_holders(primitive))
    materials: list[Json] = draft.root.get("materials", [])
    for index, holders in sorted(ours.items()):
        shifted = copy.deepcopy(materials[index])
        if not _shift_texture_infos(shifted):
            continue
        if index not in others:
            materials[index] = shifted
            continue
        materials.append(shifted)
        for holder in holders:
            holder["material"] = len(materials) - 1


def _material_holders(primitive: Json) -> list[Json]:
    """The objects in a primitive whose member `material` is a reference."""
    variants = primitive.get("extensions", {}).get(VARIANTS, {}).get("mappings", [])
    return [holder for holder in (primitive, *variants) if "material" in holder]


def _shift_names(primitive: Json) -> None:
    for attributes in (primitive["attributes"], *primitive.get("targets", [])):
        renamed = {_shifted(name): accessor for name, accessor in attributes.items()}
        attributes.clear()
        attributes.update(renamed)


def _shifted(name: str) -> str:
    match = _SET_NAME.fullmatch(name)
    return f"TEXCOORD_{int(match[1]) + 1}" if match else name


def _shift_texture_infos(value: Any) -> int:
    """Let every texture reference below a value use the next UV set; returns how many there are.

    A texture reference is an object with an `index` under a name that ends in "texture": so are
    those of the core and of all published extensions.
    """
    found = 0
    if isinstance(value, list):
        return sum(_shift_texture_infos(element) for element in value)
    if not isinstance(value, dict):
        return 0
    for key, child in value.items():
        if key == "extras":
            continue
        if isinstance(child, dict) and key.lower().endswith("texture") and "index" in child:
            found += 1
            child["texCoord"] = child.get("texCoord", 0) + 1
            transform = child.get("extensions", {}).get(TEXTURE_TRANSFORM, {})
            if "texCoord" in transform:
                transform["texCoord"] += 1
        found += _shift_texture_infos(child)
    return found
