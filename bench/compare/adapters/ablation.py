"""Our engine with a step left out, or with another part tree."""

from __future__ import annotations

import json
import os

import partuv_engine
from partuv_worker.features.normals import unit_normals

from bench.compare.adapters.exchange import Atlas, Mesh, answer


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    """arguments: {"ablation": {...}, "options": {...}, "tree": "normals"} as JSON, all optional."""
    changed = json.loads(arguments[0])
    ablation, options = partuv_engine.Ablation(), partuv_engine.Options()
    for name, value in changed.get("ablation", {}).items():
        setattr(ablation, name, value)
    for name, value in changed.get("options", {}).items():
        setattr(options, name, partuv_engine.Flattener[value] if name == "flattening" else value)
    features = unit_normals(mesh.positions, mesh.faces) if "tree" in changed else None
    context = partuv_engine.Context(threads=os.cpu_count() or 1)
    atlas = partuv_engine.unwrap(
        mesh.positions, mesh.faces, options, context, features=features, ablation=ablation
    )
    return Atlas(atlas.corner_uv)


if __name__ == "__main__":
    answer(unwrap)
