"""Every place in a document that refers to an accessor, a buffer view or a UV set.

The reader walks them once to check them; the writer walks them again to follow what it moved.
"""

from __future__ import annotations

from collections.abc import Iterator

from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.extensions import (
    ANIMATION_POINTER,
    INSTANCING,
    TEXTURE_TRANSFORM,
    VARIANTS,
)

_LARGEST_SET = 1000


def check_references(root: Cursor) -> None:
    """Refuse a document with a reference that is no index or leads nowhere."""
    accessors, views = root.length("accessors"), root.length("bufferViews")
    for reference in accessor_references(root):
        reference.as_index(accessors, "accessor")
    for view_owner in view_owners(root):
        view_owner.need("bufferView").as_index(views, "buffer view")
    materials = root.elements("materials")
    for material in materials:
        _check_sets(material)
    for animation in root.elements("animations"):
        for channel in animation.elements("channels"):
            path = pointer_of(channel)
            if path is not None:
                path.as_text()
    for primitive in primitives(root):
        for holder in material_holders(primitive):
            holder.index("material", len(materials), "material")
        _check_sets(primitive.get("extensions"))


def primitives(root: Cursor) -> Iterator[Cursor]:
    """All primitives of all meshes."""
    for mesh in root.elements("meshes"):
        yield from mesh.elements("primitives")


def attribute_maps(primitive: Cursor) -> Iterator[Cursor]:
    """The attributes of a primitive and of its morph targets."""
    yield primitive.need("attributes")
    yield from primitive.elements("targets")


def accessor_references(root: Cursor) -> Iterator[Cursor]:
    """Every number that is an accessor."""
    for primitive in primitives(root):
        for attributes in attribute_maps(primitive):
            yield from (reference for _, reference in attributes.items())
        yield from _members(primitive, "indices")
    for animation in root.elements("animations"):
        for sampler in animation.elements("samplers"):
            yield from _members(sampler, "input", "output")
    for skin in root.elements("skins"):
        yield from _members(skin, "inverseBindMatrices")
    for node in root.elements("nodes"):
        instances = _extension(node, INSTANCING)
        arrays = instances.get("attributes") if instances is not None else None
        if arrays is not None:
            yield from (reference for _, reference in arrays.items())


def view_owners(root: Cursor) -> Iterator[Cursor]:
    """Every object whose member `bufferView` is a buffer view."""
    for accessor in root.elements("accessors"):
        yield from views_of(accessor)
    for image in root.elements("images"):
        if image.get("bufferView") is not None:
            yield image


def views_of(accessor: Cursor) -> Iterator[Cursor]:
    """The objects of an accessor whose member `bufferView` is a buffer view."""
    if accessor.get("bufferView") is not None:
        yield accessor
    sparse = accessor.get("sparse")
    if sparse is not None:
        yield from (sparse.need(part) for part in ("indices", "values"))


def material_holders(primitive: Cursor) -> Iterator[Cursor]:
    """The objects of a primitive whose member `material` is a material."""
    if primitive.get("material") is not None:
        yield primitive
    variants = _extension(primitive, VARIANTS)
    for mapping in variants.elements("mappings") if variants is not None else ():
        if mapping.get("material") is not None:
            yield mapping


def texture_infos(owner: Cursor | None) -> Iterator[Cursor]:
    """Every texture reference below an object.

    It is an object with an `index` under a name that ends in "texture": so are those of the core
    and of all published extensions. Extras are the client's own and left alone.
    """
    if owner is None:
        return
    if isinstance(owner.value, list):
        for number, value in enumerate(owner.value):
            yield from texture_infos(Cursor(value, f"{owner.pointer}/{number}"))
    if not isinstance(owner.value, dict):
        return
    for key, child in owner.items():
        if key == "extras":
            continue
        if (
            key.lower().endswith("texture")
            and isinstance(child.value, dict)
            and child.get("index") is not None
        ):
            yield child
        yield from texture_infos(child)


def transform_of(info: Cursor) -> Cursor | None:
    """The transform of a texture reference, which may name a UV set of its own."""
    return _extension(info, TEXTURE_TRANSFORM)


def pointer_of(channel: Cursor) -> Cursor | None:
    """The JSON pointer that an animation channel moves, if it is of that kind."""
    target = channel.get("target")
    extension = _extension(target, ANIMATION_POINTER) if target is not None else None
    return extension.get("pointer") if extension is not None else None


def _check_sets(owner: Cursor | None) -> None:
    for info in texture_infos(owner):
        info.integer("texCoord", 0, 0, _LARGEST_SET)
        transform = transform_of(info)
        if transform is not None:
            transform.integer("texCoord", 0, 0, _LARGEST_SET)


def _members(owner: Cursor, *keys: str) -> Iterator[Cursor]:
    for key in keys:
        found = owner.get(key)
        if found is not None:
            yield found


def _extension(owner: Cursor, name: str) -> Cursor | None:
    extensions = owner.get("extensions")
    return None if extensions is None else extensions.get(name)
