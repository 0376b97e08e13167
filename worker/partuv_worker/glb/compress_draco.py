"""Geometry stored as KHR_draco_mesh_compression: exactly the same numbers in the same order.

Draco earns its name by rounding; without it, only the triangles and repeated values get smaller.
It is here for programs that read nothing else; `EXT_meshopt_compression` is the smaller one.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

import DracoPy
import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import (
    COLUMNS_AND_ROWS,
    COMPONENT_DTYPES,
    FLOAT,
    UNSIGNED_BYTE,
    UNSIGNED_INT,
    UNSIGNED_SHORT,
    element_bytes,
)
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.primitives import TRIANGLES
from partuv_worker.glb.references import accessor_references

Json = dict[str, Any]
Array = NDArray[Any]

_KINDS = (FLOAT, UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT)  # what the encoder takes
_UNROUNDED = 0  # bits
_POSITION = 0  # type of an attribute within a stream


def draco_streams(
    root: Json, content_of: Callable[[int], bytes | memoryview]
) -> list[tuple[Json, bytes, dict[str, int]]]:
    """The primitives that can be a Draco stream, their streams, and the id of each attribute in it.

    A stream has arrays of its own, so what primitives share stays as it is, and so do sparse and
    signed arrays. Only a stream that decodes to the same bytes is returned.
    """
    uses = Counter(reference.value for reference in accessor_references(Cursor(root, "")))

    def own(index: int) -> Array | None:
        json = root["accessors"][index]
        if uses[index] > 1 or json["componentType"] not in _KINDS:
            return None
        if "bufferView" not in json or "sparse" in json or COLUMNS_AND_ROWS[json["type"]][0] > 1:
            return None
        return _values(root, json, content_of)

    found = []
    for mesh in root.get("meshes", []):
        for primitive in mesh["primitives"]:
            attributes = {name: own(index) for name, index in primitive["attributes"].items()}
            arrays = {name: array for name, array in attributes.items() if array is not None}
            is_list = primitive.get("mode", TRIANGLES) == TRIANGLES
            corners = own(primitive["indices"]) if is_list and "indices" in primitive else None
            if corners is None or "POSITION" not in arrays:
                continue
            encoded = _encoded(corners.ravel(), arrays)
            if encoded is not None:
                found.append((primitive, *encoded))
    return found


def _values(root: Json, json: Json, content_of: Callable[[int], bytes | memoryview]) -> Array:
    """The components of a plain accessor (count x width)."""
    dtype = np.dtype(COMPONENT_DTYPES[json["componentType"]])
    size = element_bytes(json["type"], dtype)
    stride = root["bufferViews"][json["bufferView"]].get("byteStride", size)
    content = content_of(json["bufferView"])
    width = COLUMNS_AND_ROWS[json["type"]][1]
    return np.ndarray(
        (json["count"], width),
        dtype,
        content,
        json.get("byteOffset", 0),
        (stride, dtype.itemsize),
    )


def _encoded(corners: Array, arrays: dict[str, Array]) -> tuple[bytes, dict[str, int]] | None:
    """A stream and the ids of its attributes; none where it would not hold the same."""
    positions = np.ascontiguousarray(arrays["POSITION"])
    if positions.dtype != np.float32 or len(corners) % 3 or len(positions) > len(corners):
        return None
    names = [name for name in arrays if name != "POSITION"]
    others = {number: np.ascontiguousarray(arrays[name]) for number, name in enumerate(names)}
    triangles = corners.reshape(-1, 3).astype(np.uint32)
    stream: bytes = DracoPy.encode(
        positions,
        triangles,
        quantization_bits=_UNROUNDED,
        preserve_order=True,
        generic_attributes=others or None,
    )
    decoded = DracoPy.decode(stream)
    back = {entry["unique_id"]: entry for entry in decoded.attributes}
    place = next(id for id, entry in back.items() if entry["attribute_type"] == _POSITION)
    same = np.array_equal(decoded.faces, triangles) and all(
        np.asarray(back[id]["data"]).reshape(array.shape).astype(array.dtype).tobytes()
        == array.tobytes()
        for id, array in [*others.items(), (place, positions)]
    )
    ids = {"POSITION": place} | {name: number for number, name in enumerate(names)}
    return (stream, ids) if same else None
