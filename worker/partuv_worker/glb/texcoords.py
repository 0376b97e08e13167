"""Where the new UV set goes, and what follows the old ones: names and texture references."""

from __future__ import annotations

import copy
import re
from collections.abc import Iterable
from typing import Any

from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.extensions import ANIMATION_POINTER
from partuv_worker.glb.references import (
    material_holders,
    pointer_of,
    texture_infos,
    transform_of,
)

Json = dict[str, Any]
_SET_NAME = re.compile(r"TEXCOORD_(0|[1-9][0-9]*)")


def first_free_set(attributes: Json) -> str:
    """The name of the lowest UV set that a primitive does not have."""
    number = 0
    while f"TEXCOORD_{number}" in attributes:
        number += 1
    return f"TEXCOORD_{number}"


def reads_normals_by(root: Json, mesh: int, number: int, uv_set: int) -> bool:
    """Whether a material of this primitive has a normal map on a UV set."""
    document = Cursor(root, "")
    primitive = document.element("meshes", mesh).element("primitives", number)
    for holder in material_holders(primitive):
        material = document.element("materials", holder.value["material"])
        for info in texture_infos(material):
            transform = transform_of(info)
            used = info.integer("texCoord", 0)
            if transform is not None:
                used = transform.integer("texCoord", used)
            if info.pointer.lower().endswith("normaltexture") and used == uv_set:
                return True
    return False


def shift_sets(root: Json, primitives: Iterable[tuple[int, int]]) -> None:
    """Move every UV set of these primitives (mesh, number) up by one, with all that refers to it.

    A material that other primitives use as well is copied for these.
    """
    chosen = set(primitives)
    ours: dict[int, list[Json]] = {}
    others: set[int] = set()
    for mesh, owner in enumerate(Cursor(root, "").elements("meshes")):
        for number, primitive in enumerate(owner.elements("primitives")):
            holders = [holder.value for holder in material_holders(primitive)]
            if (mesh, number) not in chosen:
                others.update(holder["material"] for holder in holders)
                continue
            for holder in holders:
                ours.setdefault(holder["material"], []).append(holder)
            _shift_names(primitive.value)
            _shift_texture_infos(primitive.get("extensions"))
    materials: list[Json] = root.get("materials", [])
    for index, holders in sorted(ours.items()):
        shifted = copy.deepcopy(materials[index])
        if not _shift_texture_infos(Cursor(shifted, "")):
            continue
        if index not in others:
            materials[index] = shifted
            continue
        materials.append(shifted)
        for holder in holders:
            holder["material"] = len(materials) - 1
        _animate_alike(root, f"/materials/{index}/", f"/materials/{len(materials) - 1}/")


def _animate_alike(root: Json, original: str, copied: str) -> None:
    """Let animations that move a material move its copy as well."""
    for animation in Cursor(root, "").elements("animations"):
        for channel in animation.elements("channels"):
            path = pointer_of(channel)
            if path is None or not path.as_text().startswith(original):
                continue
            twin = copy.deepcopy(channel.value)
            extension = twin["target"]["extensions"][ANIMATION_POINTER]
            extension["pointer"] = copied + path.as_text().removeprefix(original)
            animation.value["channels"].append(twin)


def _shift_names(primitive: Json) -> None:
    for attributes in (primitive["attributes"], *primitive.get("targets", [])):
        renamed = {_shifted(name): accessor for name, accessor in attributes.items()}
        attributes.clear()
        attributes.update(renamed)


def _shifted(name: str) -> str:
    match = _SET_NAME.fullmatch(name)
    return f"TEXCOORD_{int(match[1]) + 1}" if match else name


def _shift_texture_infos(owner: Cursor | None) -> int:
    """Let every texture reference below an object use the next UV set; returns how many."""
    infos = list(texture_infos(owner))
    for info in infos:
        info.value["texCoord"] = info.integer("texCoord", 0) + 1
        transform = transform_of(info)
        if transform is not None and "texCoord" in transform.value:
            transform.value["texCoord"] += 1
    return len(infos)
