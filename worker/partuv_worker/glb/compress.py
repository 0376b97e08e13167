"""Geometry stored as EXT_meshopt_compression: smaller, and exactly the same numbers."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import meshopt
import numpy as np

from partuv_worker.glb.accessors import COMPONENT_DTYPES, element_bytes
from partuv_worker.glb.primitives import TRIANGLES

Json = dict[str, Any]

_LARGEST_STRIDE = 256


@dataclass(frozen=True)
class Stream:
    """The compressed bytes of a buffer view and how to read them."""

    content: bytes
    mode: str
    stride: int
    count: int


@dataclass(frozen=True)
class _Use:
    mode: str
    stride: int
    whole: bool  # the accessor covers its view from the first byte to the last


def compress_views(
    root: Json, content_of: Callable[[int], bytes | memoryview]
) -> dict[int, Stream]:
    """Streams for the buffer views that hold vertices or indices and nothing else.

    Triangles may come back turned (another corner first), which changes nothing that is drawn.
    """
    uses: dict[int, set[_Use]] = {}
    for view, use in _geometry_uses(root):
        uses.setdefault(view, set()).add(use)
    for view in _other_uses(root):
        uses.pop(view, None)
    streams = {}
    for view, found in sorted(uses.items()):
        length = root["bufferViews"][view]["byteLength"]
        use = next(iter(found))
        if len({(other.mode, other.stride) for other in found}) > 1 or length % use.stride:
            continue
        if use.mode == "ATTRIBUTES":
            if use.stride % 4 or use.stride > _LARGEST_STRIDE:
                continue
            rows = np.frombuffer(content_of(view), np.uint8).reshape(-1, use.stride)
        else:
            if use.stride == 1 or not all(other.whole for other in found):
                continue
            rows = np.frombuffer(content_of(view), f"<u{use.stride}")
        encoded = meshopt.encode_gltf_buffer(rows, use.mode)
        streams[view] = Stream(encoded, use.mode, use.stride, length // use.stride)
    return streams


def _geometry_uses(root: Json) -> Iterator[tuple[int, _Use]]:
    for mesh in root.get("meshes", []):
        for primitive in mesh["primitives"]:
            for attributes in (primitive["attributes"], *primitive.get("targets", [])):
                for accessor in attributes.values():
                    yield from _use(root, accessor, "ATTRIBUTES")
            if "indices" in primitive:
                is_list = primitive.get("mode", TRIANGLES) == TRIANGLES
                fits = root["accessors"][primitive["indices"]]["count"] % 3 == 0
                mode = "TRIANGLES" if is_list and fits else "INDICES"
                yield from _use(root, primitive["indices"], mode)


def _use(root: Json, index: int, mode: str) -> Iterator[tuple[int, _Use]]:
    accessor = root["accessors"][index]
    if "bufferView" not in accessor:
        return
    view = root["bufferViews"][accessor["bufferView"]]
    size = element_bytes(accessor["type"], COMPONENT_DTYPES[accessor["componentType"]])
    stride = view.get("byteStride", size)
    whole = not accessor.get("byteOffset") and accessor["count"] * stride == view["byteLength"]
    yield accessor["bufferView"], _Use(mode, stride, whole)


def _other_uses(root: Json) -> Iterator[int]:
    """Views that something else than a primitive reads."""
    yield from (image["bufferView"] for image in root.get("images", []) if "bufferView" in image)
    drawn = {
        accessor
        for mesh in root.get("meshes", [])
        for primitive in mesh["primitives"]
        for accessor in _accessors(primitive)
    }
    for index, accessor in enumerate(root.get("accessors", [])):
        if index not in drawn and "bufferView" in accessor:
            yield accessor["bufferView"]
        sparse = accessor.get("sparse", {})
        yield from (sparse[part]["bufferView"] for part in ("indices", "values") if part in sparse)


def _accessors(primitive: Json) -> Iterator[int]:
    for attributes in (primitive["attributes"], *primitive.get("targets", [])):
        yield from attributes.values()
    if "indices" in primitive:
        yield primitive["indices"]
