"""PartUV service: the whole way from the GLB's bytes to the finished GLB's."""

from __future__ import annotations

import os

from partuv_contract.options import UnwrapOptions
from partuv_worker.pipeline import unwrap_glb

from bench.compare.adapters.exchange import Atlas, Mesh, answer


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    """arguments: the options as JSON."""
    options = UnwrapOptions.model_validate_json(arguments[0])
    result = unwrap_glb(mesh.glb.read_bytes(), options, threads=os.cpu_count() or 1)
    return Atlas(result.atlas.corner_uv, result.soup.positions, result.soup.faces)


if __name__ == "__main__":
    answer(unwrap)
