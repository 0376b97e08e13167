"""The surface as a GLB that shows its parts."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import FLOAT, UNSIGNED_BYTE, UNSIGNED_INT
from partuv_worker.glb.fresh import FreshGlb
from partuv_worker.parts.colors import part_color


def coloured_glb(positions: NDArray[Any], faces: NDArray[Any], part: NDArray[Any]) -> bytes:
    """One mesh, triangles in the given order: COLOR_0 and _PART (a float) tell the part of each.

    positions: V x 3; faces: F x 3; part: F. Vertices are shared within parts only. There are no
    normals: viewers shade it flat.
    """
    count = int(part.max()) + 1
    keys = faces.astype(np.int64) * count + part[:, None]
    found, corners = np.unique(keys.ravel(), return_inverse=True)
    vertex, owner = np.divmod(found, count)
    glb = FreshGlb()
    attributes = {
        "POSITION": glb.positions(positions[vertex]),
        "COLOR_0": glb.attribute(_colors(count)[owner], UNSIGNED_BYTE, "VEC4", normalized=True),
        "_PART": glb.attribute(owner, FLOAT, "SCALAR"),
    }
    indices = glb.indices(corners.reshape(-1, 3), UNSIGNED_INT)
    primitive = {"attributes": attributes, "indices": indices, "material": 0}
    surface = {"baseColorFactor": [1, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 1}
    return glb.finish(
        {
            "asset": {"version": "2.0", "generator": "partuv"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"name": "parts", "mesh": 0}],
            "meshes": [{"name": "parts", "primitives": [primitive]}],
            "materials": [{"pbrMetallicRoughness": surface, "doubleSided": True}],
        }
    )


def _colors(count: int) -> NDArray[np.uint8]:
    """Linear RGBA of every part, as glTF has vertex colours."""
    srgb = np.array([part_color(number) for number in range(count)]) / 255
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    opaque = np.concatenate([linear, np.ones((count, 1))], axis=1)
    return np.round(opaque * 255).astype(np.uint8)
