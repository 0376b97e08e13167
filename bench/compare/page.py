"""`docs/benchmarks.md`: what the results in the cache say."""

from __future__ import annotations

import os
import platform
from collections.abc import Mapping
from pathlib import Path

from bench.compare.meshes import OWN_SET
from bench.compare.pictures import draw_atlases
from bench.compare.plots import plot_charts, plot_seconds
from bench.compare.results import Results
from bench.compare.summary import ByMesh, by_tool
from bench.compare.tables import compared_table, meshes_table, steps_table
from bench.compare.tools import ABLATIONS, COMPARED, OURS

_PICTURED_MESHES = ("robot", "robot-noisy")

_INTRODUCTION = """\
# Benchmarks

Written by `make bench` (`make bench MESHES=folder` for other meshes than its own shapes); do not
edit. Every tool unwraps the same GLBs in a process and an environment of its own; all atlases are
judged by the same code (`bench/compare/judge`) from their triangles alone.

| figure | meaning |
| --- | --- |
| charts | faces connected through edges with the same UVs at both ends; the sum over the meshes |
| seams | length in space of the edges between faces across which UVs jump |
| roughness | length of the seams over that of the same, smoothed over about 8 edges; the mean |
| slivers | charts that hold no circle of 2 texels at 1024 where the surface has room for one |
| worst area | largest mean area distortion of a chart (Eq. 1 of the PartUV paper; 1 is none) |
| angular | the paper's angular score (1 is conformal), blind to stretch along U or V |
| all frames | its mean over all rotations of the charts, which is not |
| flips, overlaps | faces wound against their chart; pairs of faces over 1e-6 deep in each other |
| least gutter | smallest distance between two charts, in texels of a 1024 texture |
| efficiency | area of all faces in the bounding square of the atlas |
| seconds, CPU | of the unwrapping alone, on the clock and on all processors together |
| peak MB | of the whole process, interpreter included |

Ratios are to PartUV service on the meshes that both finished: geometric means of charts and seams,
sums of seconds. Tools run one at a time, but a machine may be busy otherwise: read times as ratios,
those of CPU seconds first.

All tools run with their defaults (`bench/compare/adapters`). PartUV's engine gets a tree of face
normals, since its own features want a checkpoint, and is packed by Blender, outside of its seconds,
since its own packing is a commercial add-on."""


def write_page(page: Path, cache: Path) -> None:
    """Write the page and the pictures beside it, from all sets in the cache."""
    pictures = page.parent / page.stem
    sections = [_INTRODUCTION, _machine()]
    stored = sorted((cache / "results").glob("*.jsonl"), key=lambda path: path.stem != OWN_SET)
    for path in stored:
        sections += _set_section(path.stem, by_tool(Results(path)), pictures)
        if path.stem == OWN_SET:
            target = pictures / "atlases.png"
            tools = [tool.name for tool in COMPARED]
            draw_atlases(target, cache / "atlases", _PICTURED_MESHES, tools)
            shown = " and ".join(_PICTURED_MESHES)
            sections.append(f"Atlases of {shown}:\n\n![atlases]({page.stem}/{target.name})")
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text("\n\n".join(sections) + "\n")


def _machine() -> str:
    return f"{os.cpu_count()} CPUs ({platform.machine()}), Python {platform.python_version()}."


def _set_section(name: str, results: Mapping[str, ByMesh], pictures: Path) -> list[str]:
    """What one set says: tables of tools and of versions of ours, plots."""
    compared = [tool.name for tool in COMPARED if tool.name in results]
    versions = [tool.name for tool in ABLATIONS if tool.name in results]
    slug = name.replace(" ", "-")
    meshes = len({mesh for by_mesh in results.values() for mesh in by_mesh})
    sections = [f"## {name.capitalize()}: {meshes} meshes", _versions(results)]
    if OURS.name in results:
        plot_charts(pictures / f"{slug}-charts.svg", compared, results, OURS.name)
        plot_seconds(pictures / f"{slug}-seconds.svg", compared, results)
        sections += [
            compared_table(compared, results, OURS.name),
            f"![charts and angles]({pictures.name}/{slug}-charts.svg)",
            f"![seconds]({pictures.name}/{slug}-seconds.svg)",
            "Charts (and seconds) per mesh:",
            meshes_table(compared, {tool: results[tool] for tool in compared}),
        ]
    if versions and versions[0] == ABLATIONS[0].name:
        sections += [
            "Our engine with a step left out or replaced, relative to all of it; the first five as "
            "in the PartUV paper. Bounds hold in every version: what a missing step cannot do "
            "costs charts.",
            steps_table(versions, results, ABLATIONS[0].name),
        ]
    return sections


def _versions(results: Mapping[str, ByMesh]) -> str:
    runs = [run for by_mesh in results.values() for run in by_mesh.values()]
    limits = " or ".join(f"{limit:g} s" for limit in sorted({run.limit_s for run in runs}))
    versions = "; ".join(sorted({run.version.partition(" [")[0] for run in runs}))
    return f"Limit per mesh and tool: {limits}. Versions: {versions}."
