"""All tools on all meshes of a set, one after the other."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from bench.compare.environments import Environments, Unavailable
from bench.compare.judge import judge
from bench.compare.meshes import MeshFile
from bench.compare.results import Result, Results
from bench.compare.running import RunFailed, RunTimedOut, run_tool
from bench.compare.tools import Tool


def measure_all(
    meshes: Sequence[MeshFile],
    tools: Sequence[Tool],
    results: Results,
    environments: Environments,
    scratch: Path,
    atlases: Path | None,
    limit_s: float,
) -> None:
    """Fill the gaps of the results. atlases: where to keep what the tools made, if at all."""
    scratch.mkdir(parents=True, exist_ok=True)
    runs = len(meshes) * len(tools)
    done = 0
    for mesh in meshes:
        digest = mesh.digest
        mesh_npz = scratch / "mesh.npz"
        faces = 0
        for tool in tools:
            done += 1
            if results.is_done(mesh.name, digest, tool.name, tool.version, limit_s):
                continue
            faces = faces or mesh.write_arrays(mesh_npz)
            known = (mesh.name, digest, faces, tool.name, tool.version)
            result = _measure(known, tool, environments, mesh_npz, mesh.glb, scratch, limit_s)
            results.add(result)
            if atlases is not None and result.status == "ok":
                atlases.mkdir(parents=True, exist_ok=True)
                shutil.copy(scratch / "atlas.npz", atlases / f"{mesh.name} {tool.name}.npz")
            print(f"[{done}/{runs}] {mesh.name}, {tool.name}: {_told(result)}", flush=True)


def _measure(
    known: tuple[str, str, int, str, str],
    tool: Tool,
    environments: Environments,
    mesh_npz: Path,
    mesh_glb: Path,
    scratch: Path,
    limit_s: float,
) -> Result:
    try:
        python = environments.python(tool)
        made = run_tool(python, tool, mesh_npz, mesh_glb, scratch / "atlas.npz", limit_s)
    except Unavailable as why:
        return Result(*known, "unavailable", limit_s, message=str(why))
    except RunTimedOut as why:
        return Result(*known, "timeout", limit_s, message=str(why))
    except RunFailed as why:
        return Result(*known, "failed", limit_s, message=str(why))
    figures = judge(made.positions, made.faces, made.corner_uv)
    return Result(*known, "ok", limit_s, made.seconds, made.cpu_seconds, made.peak_rss_mb, figures)


def _told(result: Result) -> str:
    if result.figures is None or result.seconds is None:
        return f"{result.status}: {result.message}"
    return f"{result.figures.charts} charts in {result.seconds:.2f} s"
