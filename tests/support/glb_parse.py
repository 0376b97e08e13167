"""A second, plain reading of GLB files, to check what the writer wrote."""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


class ParsedGlb:
    """Document and arrays of a well-formed GLB with one buffer."""

    def __init__(self, data: bytes) -> None:
        magic, version, length = struct.unpack_from("<4sII", data)
        assert (magic, version, length) == (b"glTF", 2, len(data))
        self.chunks: list[tuple[int, bytes]] = []
        position = 12
        while position < len(data):
            size, kind = struct.unpack_from("<II", data, position)
            assert size % 4 == 0
            self.chunks.append((kind, data[position + 8 : position + 8 + size]))
            position += 8 + size
        self.json: dict[str, Any] = json.loads(self.chunks[0][1])
        self.binary = self.chunks[1][1] if len(self.chunks) > 1 else b""

    def view(self, index: int) -> bytes:
        view = self.json["bufferViews"][index]
        assert view["buffer"] == 0
        start = view.get("byteOffset", 0)
        end = start + view["byteLength"]
        assert end <= self.json["buffers"][0]["byteLength"] <= len(self.binary)
        return self.binary[start:end]

    def array(self, index: int) -> np.ndarray:
        """An accessor as stored (count x width), sparse elements in place."""
        accessor = self.json["accessors"][index]
        dtype = np.dtype(_DTYPES[accessor["componentType"]])
        width, count = _WIDTHS[accessor["type"]], accessor["count"]
        values = np.zeros((count, width), dtype)
        if "bufferView" in accessor:
            stride = self.json["bufferViews"][accessor["bufferView"]].get("byteStride")
            source = self.view(accessor["bufferView"])
            start = accessor.get("byteOffset", 0)
            assert (start + self.json["bufferViews"][accessor["bufferView"]]["byteOffset"]) % (
                dtype.itemsize
            ) == 0
            for row in range(count):
                offset = start + row * (stride or dtype.itemsize * width)
                values[row] = np.frombuffer(source, dtype, width, offset)
        if "sparse" in accessor:
            sparse = accessor["sparse"]
            kind = np.dtype(_DTYPES[sparse["indices"]["componentType"]])
            places = np.frombuffer(self.view(sparse["indices"]["bufferView"]), kind)
            source = np.frombuffer(self.view(sparse["values"]["bufferView"]), dtype)
            values[places[: sparse["count"]]] = source.reshape(-1, width)[: sparse["count"]]
        return values

    def primitive(self, mesh: int = 0, number: int = 0) -> dict[str, Any]:
        found: dict[str, Any] = self.json["meshes"][mesh]["primitives"][number]
        return found

    def corners(self, name: str, mesh: int = 0, number: int = 0) -> np.ndarray:
        """An attribute per corner of a TRIANGLES primitive (F x 3 x width)."""
        primitive = self.primitive(mesh, number)
        assert primitive.get("mode", 4) == 4
        values = self.array(primitive["attributes"][name])
        order = (
            self.array(primitive["indices"]).ravel()
            if "indices" in primitive
            else np.arange(len(values))
        )
        order = order[: len(order) // 3 * 3]
        return values[order].reshape(-1, 3, values.shape[1])
