"""The official PartUV engine, on a tree of face normals (the paper's ablation b).

PartField needs a checkpoint that is not at hand everywhere, so the tree is Ward's on the normals of
adjacent faces, for everybody. The engine leaves packing to a commercial add-on; Blender does it
here, and the time that takes is not counted.
"""

from __future__ import annotations

import importlib.util
import tempfile
import warnings
from importlib.machinery import EXTENSION_SUFFIXES
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from sklearn.cluster import ward_tree

from bench.compare.adapters.blender_mesh import edited_uv
from bench.compare.adapters.exchange import Atlas, Mesh, Stopwatch, answer

Array = NDArray[Any]

_THRESHOLD = 1.25
_CONFIG = f"unwrap_aabb: true\npamo: false\nthreshold: {_THRESHOLD}\n"
_MARGIN = 0.001


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    engine = _load_engine()
    positions = mesh.positions - mesh.positions.min(axis=0)
    positions /= positions.max()
    corners = positions[mesh.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    faces, normals = mesh.faces[lengths > 0], normals[lengths > 0] / lengths[lengths > 0, None]
    stopwatch = Stopwatch()
    with stopwatch.running(), tempfile.NamedTemporaryFile("w", suffix=".yaml") as config:
        config.write(_CONFIG)
        config.flush()
        _, parts = engine.pipeline_numpy(
            np.asfortranarray(positions),
            np.asfortranarray(faces),
            _normals_tree(faces, normals),
            config.name,
            _THRESHOLD,
            False,
        )
    charts = [chart for part in parts for chart in part.components]
    sizes = np.cumsum([0, *(len(chart.V) for chart in charts)])
    joined = np.concatenate([np.asarray(chart.V) for chart in charts])
    own_faces = np.concatenate(
        [np.asarray(chart.F) + first for chart, first in zip(charts, sizes, strict=False)]
    )
    uv = np.concatenate([np.asarray(chart.UV)[np.asarray(chart.F)] for chart in charts])

    def pack() -> None:
        bpy.ops.uv.pack_islands(margin=_MARGIN)

    packed = edited_uv(joined, own_faces, uv, pack)
    return Atlas(packed, joined, own_faces, stopwatch)


def _load_engine() -> ModuleType:
    """The extension alone: the package around it wants torch."""
    package = importlib.util.find_spec("partuv")
    if package is None or package.origin is None:
        raise ModuleNotFoundError("partuv")
    folder = Path(package.origin).parent
    path = next(p for suffix in EXTENSION_SUFFIXES for p in folder.glob(f"_core*{suffix}"))
    spec = importlib.util.spec_from_file_location("_core", path)
    assert spec is not None
    assert spec.loader is not None
    engine = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(engine)
    return engine


def _normals_tree(faces: Array, normals: Array) -> dict[int, dict[str, int]]:
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    order = np.lexsort((sides[:, 1], sides[:, 0]))
    same = (sides[order][1:] == sides[order][:-1]).all(axis=1)
    one, other = order[:-1][same] // 3, order[1:][same] // 3
    count = len(faces)
    links = coo_matrix((np.ones(len(one)), (one, other)), shape=(count, count))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that components are joined
        children = ward_tree(normals, connectivity=links + links.T)[0]
    return {
        count + merge: {"left": int(left), "right": int(right)}
        for merge, (left, right) in enumerate(children)
    }


if __name__ == "__main__":
    answer(unwrap)
