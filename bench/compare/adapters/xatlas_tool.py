"""xatlas with its defaults; `scaled`: the mesh brought to extent 100 first."""

from __future__ import annotations

import numpy as np
import xatlas

from bench.compare.adapters.exchange import Atlas, Mesh, answer, square_texels

_EXTENT = 100.0


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    positions = mesh.positions
    if "scaled" in arguments:
        positions = (positions - positions.min(axis=0)) * (
            _EXTENT / np.ptp(positions, axis=0).max()
        )
    atlas = xatlas.Atlas()
    atlas.add_mesh(positions.astype(np.float32), mesh.faces.astype(np.uint32))
    atlas.generate()
    _, indices, uv = atlas[0]
    return Atlas(square_texels(uv, atlas.width, atlas.height)[indices])


if __name__ == "__main__":
    answer(unwrap)
