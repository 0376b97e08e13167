"""Open3D's UVAtlas with its defaults; it refuses meshes that are not manifold."""

from __future__ import annotations

import ctypes
import importlib.util
from pathlib import Path

import numpy as np

from bench.compare.adapters.exchange import Atlas, Mesh, Stopwatch, answer


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    """Open3D takes libusb from the system; what is loaded already serves as well."""
    package = importlib.util.find_spec("libusb_package")
    if package is not None and package.origin is not None:
        for library in Path(package.origin).parent.glob("libusb-1.0.so*"):
            ctypes.CDLL(str(library), mode=ctypes.RTLD_GLOBAL)
    import open3d

    stopwatch = Stopwatch()
    with stopwatch.running():
        surface = open3d.t.geometry.TriangleMesh(
            open3d.core.Tensor(mesh.positions.astype(np.float32)),
            open3d.core.Tensor(mesh.faces.astype(np.int64)),
        )
        surface.compute_uvatlas()
    return Atlas(surface.triangle["texture_uvs"].numpy(), stopwatch=stopwatch)


if __name__ == "__main__":
    answer(unwrap)
