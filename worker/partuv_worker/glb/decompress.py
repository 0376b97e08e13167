"""Compressed geometry replaced by plain: afterwards nothing else need know of compression."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import LimitError, UnsupportedError

from partuv_worker.glb.accessors import COLUMNS_AND_ROWS, COMPONENT_DTYPES
from partuv_worker.glb.buffers import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER, Buffers
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.draco_stream import DracoMesh
from partuv_worker.glb.extensions import DRACO, MESHOPT_NAMES
from partuv_worker.glb.limits import Limits
from partuv_worker.glb.meshopt_stream import CompressedView

Json = dict[str, Any]
_TRIANGLES = 4


def decompress(root: Cursor, buffers: Buffers, limits: Limits) -> set[int]:
    """Decode Draco primitives and meshopt views; edits the document.

    Returns the buffer views that held streams and that nothing refers to any more.
    """
    budget = _Budget(limits)
    _decode_views(root, buffers, budget)
    left = _DracoDecoder(root, buffers, budget).decode_all()
    for key in ("extensionsUsed", "extensionsRequired"):
        names = [cursor.value for cursor in root.elements(key)]
        kept = [name for name in names if name != DRACO and name not in MESHOPT_NAMES]
        if len(kept) < len(names):
            root.value[key] = kept
            if not kept:
                del root.value[key]
    return left


class _Budget:
    """Bounds what streams may grow to, before they are decoded."""

    def __init__(self, limits: Limits) -> None:
        self._limits = limits
        self._left = limits.decoded_bytes

    def spend(self, decoded_bytes: int, stream_bytes: int, owner: Cursor) -> None:
        """Refuse a stream that would decode to more than is allowed."""
        self._left -= decoded_bytes
        if self._left < 0:
            raise LimitError(
                f"the compressed streams hold more than {self._limits.decoded_bytes} bytes",
                pointer=owner.pointer,
            )
        if decoded_bytes > stream_bytes * self._limits.expansion:
            raise LimitError(
                f"{stream_bytes} bytes claim to hold {decoded_bytes}", pointer=owner.pointer
            )


def _decode_views(root: Cursor, buffers: Buffers, budget: _Budget) -> None:
    """Turn each meshopt view into a plain one of the same number."""
    for view in root.elements("bufferViews"):
        extensions = view.get("extensions")
        if extensions is None:
            continue
        name = next((name for name in MESHOPT_NAMES if extensions.get(name)), None)
        if name is None:
            continue
        declared = extensions.need(name)
        compressed = CompressedView(declared, view)
        stream = buffers.range_of(declared)
        budget.spend(compressed.size_bytes, len(stream), declared)
        content = compressed.decode(stream)
        view.value.update(buffer=buffers.append(content), byteOffset=0)
        del extensions.value[name]
        if not extensions.value:
            del view.value["extensions"]


class _DracoDecoder:
    """Decodes each stream once and stores what primitives take from it as plain views."""

    def __init__(self, root: Cursor, buffers: Buffers, budget: _Budget) -> None:
        self._root = root
        self._buffers = buffers
        self._budget = budget
        self._streams: set[int] = set()
        self._meshes: dict[int, DracoMesh] = {}
        accessors = root.elements("accessors")
        self._plain = {place.pointer for place in accessors if place.get("bufferView")}
        self._filled: dict[int, tuple[int, int | None]] = {}  # accessor -> its source

    def decode_all(self) -> set[int]:
        for mesh in self._root.elements("meshes"):
            for primitive in mesh.elements("primitives"):
                extensions = primitive.get("extensions")
                declared = extensions.get(DRACO) if extensions is not None else None
                if extensions is None or declared is None:
                    continue
                self._decode(primitive, declared)
                del extensions.value[DRACO]
                if not extensions.value:
                    del primitive.value["extensions"]
        return self._streams

    def _decode(self, primitive: Cursor, declared: Cursor) -> None:
        indices = self._accessor(primitive.need("indices"))
        if primitive.integer("mode", _TRIANGLES) != _TRIANGLES:
            raise UnsupportedError("a Draco primitive that is no list", pointer=primitive.pointer)
        view = declared.need("bufferView").as_index(self._buffers.view_count(), "buffer view")
        self._streams.add(view)
        attributes = primitive.need("attributes")
        sources = dict(declared.need("attributes").items())
        places = {name: self._accessor(attributes.need(name)) for name in sources}
        if all(place.pointer in self._plain for place in (indices, *places.values())):
            return  # the same primitive is there uncompressed, for readers without Draco
        corner_count = indices.need("count").as_integer(3)
        if view not in self._meshes:
            self._check_budget(view, corner_count, list(places.values()), declared)
            content = self._buffers.view(view).content
            self._meshes[view] = DracoMesh(content, corner_count // 3, declared)
        mesh = self._meshes[view]
        if len(mesh.corners) != corner_count:
            indices.fail(f"the Draco stream holds {len(mesh.corners)} indices")
        self._fill(primitive, "indices", (view, None), mesh.corners[:, None])
        for name, unique_id in sources.items():
            number = unique_id.as_integer()
            values = mesh.attribute(number, unique_id)
            self._fill(attributes, name, (view, number), values)

    def _accessor(self, reference: Cursor) -> Cursor:
        count = self._root.length("accessors")
        return self._root.element("accessors", reference.as_index(count, "accessor"))

    def _check_budget(
        self, view: int, corner_count: int, places: list[Cursor], declared: Cursor
    ) -> None:
        size_bytes = 4 * corner_count
        for place in places:
            count = place.need("count").as_integer(1)
            if count > corner_count:
                place.fail(f"{count} vertices for {corner_count} corners")
            size_bytes += count * _shape(place)[1] * 4
        self._budget.spend(size_bytes, len(self._buffers.view(view).content), declared)

    def _fill(
        self, owner: Cursor, key: str, source: tuple[int, int | None], values: NDArray[Any]
    ) -> None:
        """Give the accessor that `owner` names under `key` a view with these values."""
        accessors: list[Json] = self._root.value["accessors"]
        index = owner.need(key).as_index(len(accessors), "accessor")
        if self._filled.setdefault(index, source) != source:
            # Accessors of Draco data have no view, so exporters may use one for several streams.
            accessors.append({k: v for k, v in accessors[index].items() if k != "bufferView"})
            index = owner.value[key] = len(accessors) - 1
            self._filled[index] = source
        place = self._root.element("accessors", index)
        dtype, width = _shape(place)
        count = place.need("count").as_integer(1)
        if values.shape != (count, width):
            place.fail(f"the Draco stream holds {len(values)} elements of {values.shape[1]}")
        stored = _stored(values, dtype, place)
        for stale in ("byteOffset", "sparse"):
            place.value.pop(stale, None)
        place.value["bufferView"] = self._add_view(stored, padded=key != "indices")
        if key == "POSITION" or "min" in place.value or "max" in place.value:
            place.value["min"] = stored.min(axis=0).tolist()
            place.value["max"] = stored.max(axis=0).tolist()

    def _add_view(self, values: NDArray[Any], padded: bool) -> int:
        """A view of these values; elements of attributes are padded to four bytes."""
        row_bytes = values.shape[1] * values.itemsize
        stride = -(-row_bytes // 4) * 4 if padded else row_bytes
        rows = np.zeros((len(values), stride), np.uint8)
        rows[:, :row_bytes] = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), -1)
        view: Json = {"buffer": self._buffers.append(rows.tobytes()), "byteLength": rows.size}
        view["target"] = ARRAY_BUFFER if padded else ELEMENT_ARRAY_BUFFER
        if stride != row_bytes:
            view["byteStride"] = stride
        return self._buffers.append_view(view)


def _shape(accessor: Cursor) -> tuple[np.dtype[Any], int]:
    component = accessor.need("componentType")
    dtype = COMPONENT_DTYPES.get(component.as_integer())
    columns, width = COLUMNS_AND_ROWS.get(accessor.need("type").as_text(), (0, 0))
    if dtype is None or columns != 1:
        accessor.fail("no accessor of numbers or vectors")
    return dtype, width


def _stored(values: NDArray[Any], dtype: np.dtype[Any], place: Cursor) -> NDArray[Any]:
    """Decoded values in the accessor's own type; refused if they do not fit."""
    if values.dtype.kind == "f" and dtype.kind != "f":
        place.fail("the Draco stream holds fractions, the accessor integers")
    if dtype.kind != "f":
        range_of_type = np.iinfo(dtype)
        if (
            values.size
            and not range_of_type.min <= values.min() <= values.max() <= range_of_type.max
        ):
            place.fail("the Draco stream holds numbers too large for the accessor")
    return values.astype(dtype)
