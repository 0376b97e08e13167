"""Coloured parts as a GLB: one node, mesh and material each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import FLOAT, UNSIGNED_SHORT
from partuv_worker.glb.buffers import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER
from partuv_worker.glb.container import join_container
from partuv_worker.glb.jsontext import format_json


@dataclass(frozen=True)
class Part:
    """A named surface of less than 65,535 vertices in one colour."""

    name: str
    color: tuple[float, float, float]  # linear RGB
    positions: NDArray[np.float32]  # V x 3
    faces: NDArray[np.uint32]  # F x 3
    normals: NDArray[np.float32]  # V x 3


def write_parts(parts: Sequence[Part]) -> bytes:
    """The GLB of these parts in one scene."""
    chunks: list[bytes] = []
    accessors: list[dict[str, Any]] = []
    views: list[dict[str, Any]] = []

    def store(array: NDArray[Any], target: int, **accessor: Any) -> int:
        content = array.tobytes()
        views.append(
            {
                "buffer": 0,
                "byteOffset": sum(map(len, chunks)),
                "byteLength": len(content),
                "target": target,
            }
        )
        chunks.append(content + bytes(-len(content) % 4))
        accessors.append({"bufferView": len(views) - 1, **accessor})
        return len(accessors) - 1

    def vectors(array: NDArray[np.float32], **bounds: Any) -> int:
        shape = {"componentType": FLOAT, "count": len(array), "type": "VEC3"}
        return store(array.astype("<f4"), ARRAY_BUFFER, **shape, **bounds)

    meshes = []
    for number, part in enumerate(parts):
        low, high = part.positions.min(axis=0), part.positions.max(axis=0)
        attributes = {
            "POSITION": vectors(part.positions, min=low.tolist(), max=high.tolist()),
            "NORMAL": vectors(part.normals),
        }
        corners = part.faces.ravel().astype("<u2")
        shape = {"componentType": UNSIGNED_SHORT, "count": len(corners), "type": "SCALAR"}
        indices = store(corners, ELEMENT_ARRAY_BUFFER, **shape)
        primitive = {"attributes": attributes, "indices": indices, "material": number}
        meshes.append({"name": part.name, "primitives": [primitive]})
    document = {
        "asset": {"version": "2.0", "generator": "partuv sample"},
        "scene": 0,
        "scenes": [{"nodes": list(range(len(parts)))}],
        "nodes": [{"name": part.name, "mesh": number} for number, part in enumerate(parts)],
        "meshes": meshes,
        "materials": [
            {
                "name": part.name,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*part.color, 1.0],
                    "metallicFactor": 0.1,
                    "roughnessFactor": 0.6,
                },
            }
            for part in parts
        ],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": sum(map(len, chunks))}],
    }
    return join_container(format_json(document), chunks, [])
