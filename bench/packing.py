"""The packer beside those of xatlas and Blender, on the same charts at the same gutter.

    python bench/packing.py charts MESH.glb ... --out charts/    # charts of our own search
    python bench/packing.py pack --with ours charts/ --out results/ours.json
    python bench/packing.py pack --with xatlas charts/ --out results/xatlas.json
    python bench/packing.py pack --with blender charts/ --out results/blender.json
    python bench/packing.py table results/*.json

Needs trimesh and the engine for `charts`, shapely for `pack`, and the packer in question: the
engine, xatlas (PyPI) or bpy (PyPI). Every packer gets 1024 texels and has to keep 4 of them between
any two charts; what the peers are told is raised until that is so, and the densest result counts.
Efficiency is the area of the charts over that of the square around them, as in the PartUV paper.
"""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

RESOLUTION = 1024
GUTTER_TEXELS = 4.0
TOLERANCE_TEXELS = 0.02  # peers may miss the gutter by this much
SLOW_CHARTS = 250  # bruteForce of xatlas and pack_islands take minutes beyond this
XATLAS_HALVINGS = 10


class Charts(NamedTuple):
    """Charts to be packed, at one scale."""

    uv: NDArray[np.float64]  # N x 2, no point belongs to two charts
    faces: NDArray[np.int32]  # F x 3
    chart: NDArray[np.int32]  # F
    part: NDArray[np.int32]  # of each chart


Attempts = list[tuple[NDArray[Any], float]]
"""Corner UVs (F x 3 x 2) and the seconds they took."""


def unwrap_charts(path: Path) -> Charts:
    """The charts that our own search finds, all at the scale of the mesh."""
    import partuv_engine
    import trimesh

    mesh = trimesh.load(path, force="mesh", process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=12)
    faces = np.ascontiguousarray(mesh.faces, np.int32)
    positions = np.ascontiguousarray(mesh.vertices, np.float64)
    atlas = partuv_engine.unwrap(
        positions, faces, partuv_engine.Options(), partuv_engine.Context(2)
    )
    corner = np.asarray(atlas.corner_uv, np.float64).reshape(-1, 2)
    chart = np.asarray(atlas.chart)
    keyed = np.column_stack([np.repeat(chart, 3), corner])
    points, inverse = np.unique(keyed, axis=0, return_inverse=True)
    scale = 1.0 / np.sqrt(np.abs(doubled_areas(corner.reshape(-1, 3, 2))).sum())
    return Charts(
        points[:, 1:] * scale,
        inverse.reshape(-1, 3).astype(np.int32),
        chart.astype(np.int32),
        np.asarray(atlas.charts["part"], np.int32),
    )


def doubled_areas(triangles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Twice the signed areas; triangles: F x 3 x 2."""
    u, v = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    areas: NDArray[np.float64] = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    return areas


def measure(charts: Charts, corner_uv: NDArray[Any]) -> tuple[float, float]:
    """Efficiency, and the least distance of two charts in texels (16 if none are nearer)."""
    import shapely

    uv = np.asarray(corner_uv, np.float64)
    flat = uv.reshape(-1, 2)
    side = (flat.max(axis=0) - flat.min(axis=0)).max()
    efficiency = 0.5 * np.abs(doubled_areas(uv)).sum() / side**2
    ends = np.concatenate(
        [charts.faces[:, [0, 1]], charts.faces[:, [1, 2]], charts.faces[:, [2, 0]]]
    )
    lines = np.concatenate([uv[:, [0, 1]], uv[:, [1, 2]], uv[:, [2, 0]]])
    owner = np.tile(charts.chart, 3)
    _, first, count = np.unique(np.sort(ends), axis=0, return_index=True, return_counts=True)
    outer = first[count == 1]
    segments = shapely.linestrings(lines[outer] * RESOLUTION)
    owner = owner[outer]
    tree = shapely.STRtree(segments)
    least = 16.0
    for reach in (1.0, 4.5, 16.0):
        one, two = tree.query(segments, predicate="dwithin", distance=reach)
        apart = owner[one] != owner[two]
        if apart.any():
            least = float(shapely.distance(segments[one[apart]], segments[two[apart]]).min())
            break
    return float(efficiency), least


def is_uniform(charts: Charts, corner_uv: NDArray[Any]) -> bool:
    """Whether the larger charts have about the same scale.

    xatlas rounds the size of every chart to texels, and shrinks those that do not fit.
    """
    count = len(charts.part)
    before = np.bincount(charts.chart, np.abs(doubled_areas(charts.uv[charts.faces])), count)
    after = np.bincount(charts.chart, np.abs(doubled_areas(np.asarray(corner_uv))), count)
    large = before > 0.02 * before.sum()
    scale = after[large] / before[large]
    return bool(scale.max() < 1.15 * scale.min())


def pack_ours(charts: Charts) -> Attempts:
    """The engine, as an unwrap calls it."""
    import partuv_engine

    options = partuv_engine.PackOptions()
    started = time.perf_counter()
    packed = partuv_engine.pack(
        charts.uv, charts.faces, charts.chart, options, partuv_engine.Context(2), part=charts.part
    )
    return [(packed.corner_uv, time.perf_counter() - started)]


def pack_xatlas(charts: Charts) -> Attempts:
    """xatlas packs at a given density: the largest that fits one atlas, for several paddings."""
    import xatlas

    def at(density: float, padding: int, brute: bool) -> Any:
        atlas = xatlas.Atlas()
        atlas.add_uv_mesh(
            charts.uv.astype(np.float32), charts.faces.astype(np.uint32), charts.chart[:, None]
        )
        options = xatlas.PackOptions()
        options.bruteForce, options.padding = brute, padding
        options.resolution, options.texels_per_unit = RESOLUTION, density
        atlas.generate(pack_options=options)
        return atlas

    attempts: Attempts = []
    total = 0.5 * np.abs(doubled_areas(charts.uv[charts.faces])).sum()
    for brute in (False, True):
        if brute and len(charts.part) > SLOW_CHARTS:
            continue
        for padding in (1, 2, 3, 4):
            high = RESOLUTION / np.sqrt(total)
            low, seconds, found = 0.1 * high, 0.0, None
            for _ in range(XATLAS_HALVINGS):
                middle = np.sqrt(low * high)
                started = time.perf_counter()
                atlas = at(middle, padding, brute)
                seconds = time.perf_counter() - started
                _, index, uv = atlas[0]
                packed = (uv * (atlas.width, atlas.height) / RESOLUTION)[index]
                if atlas.atlas_count != 1 or not is_uniform(charts, packed):
                    high = middle
                    continue
                low, found = middle, packed
            if found is None:
                continue
            attempts.append((found, seconds))
            if measure(charts, found)[1] >= GUTTER_TEXELS - TOLERANCE_TEXELS:
                break
    return attempts


def pack_blender(charts: Charts) -> Attempts:
    """Blender's pack_islands, concave shapes and any rotation; the margin follows the gutter."""
    if len(charts.part) > SLOW_CHARTS:
        return []
    attempts: Attempts = []
    margin = 0.5 * GUTTER_TEXELS / RESOLUTION
    for _ in range(4):
        found, seconds = _pack_islands(charts, margin)
        attempts.append((found, seconds))
        reached = measure(charts, found)[1]
        if reached >= GUTTER_TEXELS - TOLERANCE_TEXELS:
            break
        margin *= 1.5 if reached <= 0.0 else 1.005 * GUTTER_TEXELS / reached
    return attempts


def _pack_islands(charts: Charts, margin: float) -> tuple[NDArray[Any], float]:
    import bpy

    bpy.ops.wm.read_factory_settings(use_empty=True)
    points = charts.uv / np.abs(charts.uv).max()
    mesh = bpy.data.meshes.new("charts")
    flat = np.column_stack([points, np.zeros(len(points))])
    mesh.from_pydata(flat.tolist(), [], charts.faces.tolist())
    corners = points[charts.faces.ravel()].astype(np.float32).ravel()
    mesh.uv_layers.new(name="uv").data.foreach_set("uv", corners)
    thing = bpy.data.objects.new("charts", mesh)
    bpy.context.scene.collection.objects.link(thing)
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.scene.tool_settings.use_uv_select_sync = True
    bpy.ops.mesh.select_all(action="SELECT")
    started = time.perf_counter()
    bpy.ops.uv.pack_islands(
        rotate=True,
        rotate_method="ANY",
        scale=True,
        shape_method="CONCAVE",
        margin_method="FRACTION",
        margin=margin,
    )
    seconds = time.perf_counter() - started
    bpy.ops.object.mode_set(mode="OBJECT")
    found = np.empty(corners.size, np.float32)
    thing.data.uv_layers[0].data.foreach_get("uv", found)
    return found.reshape(-1, 3, 2), seconds


PACKERS: dict[str, Callable[[Charts], Attempts]] = {
    "ours": pack_ours,
    "xatlas": pack_xatlas,
    "blender": pack_blender,
}


def run_packer(name: str, files: list[Path], out: Path) -> None:
    """Pack every file with one packer and note the densest attempt that keeps the gutter."""
    out.parent.mkdir(parents=True, exist_ok=True)
    rows = json.loads(out.read_text()) if out.is_file() else {}
    for path in files:
        if path.stem in rows:
            continue
        charts = Charts(**np.load(path))
        measured = [(*measure(charts, uv), seconds) for uv, seconds in PACKERS[name](charts)]
        least = GUTTER_TEXELS - (0.0 if name == "ours" else TOLERANCE_TEXELS)
        kept = [one for one in measured if one[1] >= least]
        best = max(kept, default=(None, None, None))
        rows[path.stem] = {
            "charts": len(charts.part),
            "efficiency": best[0],
            "gutter_texels": best[1],
            "seconds": best[2],
        }
        print(name, path.stem, rows[path.stem], flush=True)
        out.write_text(json.dumps(rows, indent=1) + "\n")


def print_table(files: list[Path]) -> None:
    """Efficiencies side by side, and ours over the best of the others."""
    results = {path.stem: json.loads(path.read_text()) for path in files}
    ours = results.pop("ours")
    print("| charts of | count | ours | " + " | ".join(results) + " | ratio | seconds |")
    print("|---" * (5 + len(results)) + "|")
    ratios = []
    for stem, row in sorted(ours.items()):
        others = [rows.get(stem, {}).get("efficiency") for rows in results.values()]
        known = [value for value in others if value]
        ratio = row["efficiency"] / max(known) if known else None
        ratios += [ratio] if ratio else []
        cells = [f"{value:.3f}" if value else "-" for value in (row["efficiency"], *others, ratio)]
        print(f"| {stem} | {row['charts']} | {' | '.join(cells)} | {row['seconds']:.2f} |")
    mean = float(np.exp(np.mean(np.log(ratios)))) if ratios else float("nan")
    least = min(ratios, default=float("nan"))
    print(f"\n{len(ratios)} compared: geometric mean of the ratios {mean:.3f}, least {least:.3f}")


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("task", choices=["charts", "pack", "table"])
    parser.add_argument("paths", nargs="+", type=Path)
    parser.add_argument("--with", dest="packer", choices=sorted(PACKERS), default="ours")
    parser.add_argument("--out", type=Path, default=Path("out/packing"))
    given = parser.parse_args()
    if given.task == "charts":
        given.out.mkdir(parents=True, exist_ok=True)
        for path in given.paths:
            charts = unwrap_charts(path)
            np.savez(given.out / f"{path.parent.name}_{path.stem}.npz", **charts._asdict())
            print(path.stem, len(charts.part), "charts", flush=True)
    elif given.task == "pack":
        files = [found for path in given.paths for found in sorted(path.glob("*.npz"))]
        run_packer(given.packer, files, given.out)
    else:
        print_table(given.paths)


if __name__ == "__main__":
    main()
