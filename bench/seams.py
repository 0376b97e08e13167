"""Slivers and rough seams of the engine's own atlases, mesh by mesh.

    python -m bench.seams MESH.glb|FOLDER ...

Every mesh is unwrapped with the default options and judged as in `bench.compare`;
`docs/benchmarks.md` says what the figures mean.
"""

from __future__ import annotations

import numpy as np

from bench.compare.judge.charts import find_charts
from bench.compare.judge.seams import seam_roughness
from bench.compare.judge.slivers import count_slivers
from bench.unwrapping import mesh_parser, named_meshes, unwrapped


def main() -> None:
    meshes = named_meshes(mesh_parser("bench.seams", __doc__).parse_args().meshes)
    print("| mesh | faces | noise | charts | slivers | roughness |")
    print("| --- |" + " ---: |" * 5, flush=True)
    slivers, roughness = 0, []
    for mesh in meshes:
        positions, faces = mesh.arrays()
        atlas = unwrapped(positions, faces)
        uv = atlas.corner_uv.astype(np.float64)
        charts = find_charts(positions, faces, uv)
        thin = count_slivers(positions, faces, uv, charts)
        rough = seam_roughness(positions, faces, charts)
        slivers += thin
        roughness += [] if rough is None else [rough]
        print(
            f"| {mesh.name} | {len(faces):,} | {atlas.noise:.2f} | {charts.count:,} | {thin} | "
            f"{'' if rough is None else f'{rough:.3f}'} |",
            flush=True,
        )
    mean = f"{np.mean(roughness):.3f}" if roughness else "none"
    print(f"\n{slivers} slivers; roughness {mean} in the mean")


if __name__ == "__main__":
    main()
