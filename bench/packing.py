"""The packer beside those of xatlas and Blender, on the same charts at the same gutter.

    python -m bench.packing run MESH.glb ... --out out/packing \
        --xatlas PYTHON --blender PYTHON    # charts of our own search, all packers, the table

and its steps, which go on where they were stopped:

    python -m bench.packing charts MESH.glb ... --out charts/
    python -m bench.packing pack --with ours charts/ --out results/ours.json
    python -m bench.packing pack --with xatlas charts/ --out results/xatlas.json
    python -m bench.packing pack --with blender charts/ --out results/blender.json
    python -m bench.packing table results/*.json

Needs the project with its extra `bench`; the interpreters of the peers need numpy, shapely and
xatlas or bpy (PyPI). Every packer gets 1024 texels and has to keep 4 of them between any two
charts; what the peers are told is raised until that is so, and the densest result counts.
Efficiency is the area of the charts over that of the square around them, as in the PartUV paper,
at the scale of the chart that was scaled least.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import partuv_worker
from numpy.typing import NDArray
from partuv_worker.measure import side_ends, signed_areas_2d

from bench.compare.adapters.exchange import Stopwatch
from bench.compare.judge.gutter import least_gutter_uv

RESOLUTION = 1024
GUTTER_TEXELS = 4.0
TOLERANCE_TEXELS = 0.02  # peers may miss the gutter by this much
SLOW_CHARTS = 250  # bruteForce of xatlas and pack_islands take minutes beyond this
XATLAS_HALVINGS = 10
MOST_UNEQUAL = 1.15  # areas of charts that xatlas shrank differently


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
    from bench.compare.meshes import meshes_at
    from bench.unwrapping import unwrapped

    (mesh,) = meshes_at(path)
    positions, faces = mesh.arrays()
    atlas = unwrapped(positions, faces)
    corner = np.asarray(atlas.corner_uv, np.float64).reshape(-1, 2)
    chart = np.asarray(atlas.chart)
    keyed = np.column_stack([np.repeat(chart, 3), corner])
    points, inverse = np.unique(keyed, axis=0, return_inverse=True)
    scale = 1.0 / np.sqrt(np.abs(signed_areas_2d(corner.reshape(-1, 3, 2))).sum())
    return Charts(
        points[:, 1:] * scale,
        inverse.reshape(-1, 3).astype(np.int32),
        chart.astype(np.int32),
        np.asarray(atlas.charts["part"], np.int32),
    )


def measure(charts: Charts, corner_uv: NDArray[Any]) -> tuple[float, float]:
    """Efficiency, and the least distance of two charts in texels (the side for one chart).

    Where charts are smaller than others, all count as if they had the scale of the smallest.
    """
    uv = np.asarray(corner_uv, np.float64)
    side = np.ptp(uv.reshape(-1, 2), axis=0).max()
    total = np.abs(signed_areas_2d(charts.uv[charts.faces])).sum()
    efficiency = total * scales(charts, uv).min() / side**2
    ends = side_ends(charts.faces)
    segments = side_ends(uv)
    _, first, count = np.unique(np.sort(ends), axis=0, return_index=True, return_counts=True)
    outer = first[count == 1]
    gutter_uv = least_gutter_uv(segments[outer], np.repeat(charts.chart, 3)[outer])
    return float(efficiency), RESOLUTION * (1.0 if gutter_uv is None else gutter_uv)


def scales(charts: Charts, corner_uv: NDArray[Any]) -> NDArray[np.float64]:
    """Areas of the larger charts as packed over those as given.

    xatlas rounds the size of every chart to texels, and shrinks those that do not fit.
    """
    count = len(charts.part)
    before = np.bincount(charts.chart, np.abs(signed_areas_2d(charts.uv[charts.faces])), count)
    after = np.bincount(charts.chart, np.abs(signed_areas_2d(np.asarray(corner_uv))), count)
    large = before > 0.02 * before.sum()
    if not large.any():
        return np.array([after.sum() / before.sum()])
    ratio: NDArray[np.float64] = after[large] / before[large]
    return ratio


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
    total = np.abs(signed_areas_2d(charts.uv[charts.faces])).sum()
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
                scale = scales(charts, packed)
                if atlas.atlas_count != 1 or scale.max() > MOST_UNEQUAL * scale.min():
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

    from bench.compare.adapters.blender_mesh import edited_uv

    points = charts.uv / np.abs(charts.uv).max()
    flat = np.column_stack([points, np.zeros(len(points))])
    stopwatch = Stopwatch()

    def pack() -> None:
        with stopwatch.running():
            bpy.ops.uv.pack_islands(
                rotate=True,
                rotate_method="ANY",
                scale=True,
                shape_method="CONCAVE",
                margin_method="FRACTION",
                margin=margin,
            )

    return edited_uv(flat, charts.faces, points[charts.faces], pack), stopwatch.seconds


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


def run_all(meshes: list[Path], out: Path, pythons: dict[str, str]) -> None:
    """Make the charts once, pack them with every packer in its interpreter, print the table."""
    write_charts(meshes, out / "charts")
    # Peers read our sources, but get nothing of what is installed for us.
    sources = [Path(__file__).parents[1], Path(partuv_worker.__file__).parents[1]]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, sources))}
    results = []
    for name, python in pythons.items():
        results.append(out / "results" / f"{name}.json")
        arguments = ["pack", "--with", name, str(out / "charts"), "--out", str(results[-1])]
        own = None if name == "ours" else environment
        subprocess.run([python, "-m", "bench.packing", *arguments], env=own, check=True)
    print_table(results)


def write_charts(meshes: list[Path], out: Path) -> None:
    """The charts of every mesh that has none there yet."""
    out.mkdir(parents=True, exist_ok=True)
    for path in meshes:
        target = out / f"{path.parent.name}_{path.stem}.npz"
        if target.is_file():
            continue
        charts = unwrap_charts(path)
        np.savez(target, **charts._asdict())
        print(path.stem, len(charts.part), "charts", flush=True)


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
    parser.add_argument("task", choices=["run", "charts", "pack", "table"])
    parser.add_argument("paths", nargs="+", type=Path)
    parser.add_argument("--with", dest="packer", choices=sorted(PACKERS), default="ours")
    parser.add_argument("--out", type=Path, default=Path("out/packing"))
    for peer in ("xatlas", "blender"):
        parser.add_argument(f"--{peer}", metavar="PYTHON", help="interpreter that has it, for run")
    given = parser.parse_args()
    if given.task == "run":
        pythons = {"ours": sys.executable, "xatlas": given.xatlas, "blender": given.blender}
        known = {name: python for name, python in pythons.items() if python}
        run_all(given.paths, given.out, known)
    elif given.task == "charts":
        write_charts(given.paths, given.out)
    elif given.task == "pack":
        files = [found for path in given.paths for found in sorted(path.glob("*.npz"))]
        run_packer(given.packer, files, given.out)
    else:
        print_table(given.paths)


if __name__ == "__main__":
    main()
