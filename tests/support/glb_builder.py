"""Small GLB files made by hand, independent of the reader and writer under test."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

import numpy as np

Json = dict[str, Any]

COMPONENT_TYPES = {"b": 5120, "B": 5121, "h": 5122, "H": 5123, "I": 5125, "f": 5126}
KINDS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "f")
TETRAHEDRON_FACES = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])


class GlbBuilder:
    """A document that grows by arrays, meshes and nodes, and can be broken at will."""

    def __init__(self) -> None:
        self.json: Json = {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": []}],
            "nodes": [],
            "meshes": [],
            "accessors": [],
            "bufferViews": [],
        }
        self.binary = b""

    def view(self, content: bytes, **more: Any) -> int:
        self.binary += bytes(-len(self.binary) % 4)
        self.json["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content), **more}
        )
        self.binary += content
        return len(self.json["bufferViews"]) - 1

    def accessor(self, array: Any, **more: Any) -> int:
        """An array (count x width) in a view of its own; its dtype gives the component type."""
        array = np.asarray(array)
        array = array[:, None] if array.ndim == 1 else array
        view = self.view(array.astype(array.dtype.newbyteorder("<")).tobytes())
        json = {
            "bufferView": view,
            "componentType": COMPONENT_TYPES[array.dtype.char],
            "count": len(array),
            "type": KINDS[array.shape[1]],
        }
        self.json["accessors"].append(json | more)
        return len(self.json["accessors"]) - 1

    def positions(self, array: Any, **more: Any) -> int:
        array = np.asarray(array)
        bounds = {"min": array.min(axis=0).tolist(), "max": array.max(axis=0).tolist()}
        return self.accessor(array, **(bounds | more))

    def mesh(self, *primitives: Json, **more: Any) -> int:
        self.json["meshes"].append({"primitives": list(primitives), **more})
        return len(self.json["meshes"]) - 1

    def node(self, *, in_scene: bool = True, **members: Any) -> int:
        self.json["nodes"].append(members)
        index = len(self.json["nodes"]) - 1
        if in_scene:
            self.json["scenes"][0]["nodes"].append(index)
        return index

    def data_uri(self) -> bytes:
        """The file with its buffer in a data URI and no BIN chunk."""
        encoded = base64.b64encode(self.binary).decode()
        uri = f"data:application/octet-stream;base64,{encoded}"
        buffers = [{"byteLength": len(self.binary), "uri": uri}]
        return pack(self.json | {"buffers": buffers}, None)

    def build(self) -> bytes:
        json_with_buffer = dict(self.json)
        if self.binary:
            json_with_buffer.setdefault("buffers", [{"byteLength": len(self.binary)}])
        return pack(json_with_buffer, self.binary or None)


def pack(document: Json | bytes, binary: bytes | None, *others: tuple[int, bytes]) -> bytes:
    """A GLB container around a document, a BIN chunk and other chunks."""
    text = document if isinstance(document, bytes) else json.dumps(document).encode()
    chunks = [(0x4E4F534A, text + b" " * (-len(text) % 4))]
    if binary is not None:
        chunks.append((0x004E4942, binary + bytes(-len(binary) % 4)))
    chunks += others
    body = b"".join(struct.pack("<II", len(c), kind) + c for kind, c in chunks)
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def tetrahedron() -> GlbBuilder:
    """One mesh of four faces under one node."""
    builder = GlbBuilder()
    primitive = {
        "attributes": {"POSITION": builder.positions(TETRAHEDRON)},
        "indices": builder.accessor(TETRAHEDRON_FACES.ravel().astype("H")),
    }
    builder.node(mesh=builder.mesh(primitive))
    return builder


def grid(columns: int, rows: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions and faces of a flat grid of 2 * columns * rows triangles."""
    y, x = np.mgrid[0 : rows + 1, 0 : columns + 1]
    points = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3).astype("f")
    corner = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    right, up = corner + 1, corner + columns + 1
    lower = np.stack([corner, right, up], axis=1)
    upper = np.stack([right, up + 1, up], axis=1)
    return points, np.stack([lower, upper], axis=1).reshape(-1, 3)
