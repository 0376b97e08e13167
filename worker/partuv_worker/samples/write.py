"""Coloured parts as a GLB: one node, mesh and material each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import FLOAT, UNSIGNED_SHORT
from partuv_worker.glb.fresh import FreshGlb


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
    glb = FreshGlb()
    meshes = []
    for number, part in enumerate(parts):
        attributes = {
            "POSITION": glb.positions(part.positions),
            "NORMAL": glb.attribute(part.normals, FLOAT, "VEC3"),
        }
        indices = glb.indices(part.faces, UNSIGNED_SHORT)
        primitive = {"attributes": attributes, "indices": indices, "material": number}
        meshes.append({"name": part.name, "primitives": [primitive]})
    return glb.finish(
        {
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
        }
    )
