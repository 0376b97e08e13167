"""uvunwrap with its defaults."""

from __future__ import annotations

import numpy as np
import uvunwrap

from bench.compare.adapters.exchange import Atlas, Mesh, answer, square_texels


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    source = uvunwrap.Mesh(mesh.positions.ravel().tolist(), mesh.faces.ravel().tolist())
    atlas = uvunwrap.generate([source])
    out = atlas.meshes[0]
    uv = np.array(out.corner_uvs, np.float64).reshape(-1, 3, 2)
    return Atlas(square_texels(uv, atlas.width, atlas.height))


if __name__ == "__main__":
    answer(unwrap)
