"""All tools on all meshes of a set, one after the other."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from functools import partial
from pathlib import Path

from partuv_contract.errors import PartuvError

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
    mesh_npz, atlas_npz = scratch / "mesh.npz", scratch / "atlas.npz"
    for number, mesh in enumerate(meshes, start=1):
        digest = mesh.digest
        missing = [
            tool
            for tool in tools
            if not results.is_done(mesh.name, digest, tool.name, tool.version, limit_s)
        ]
        if not missing:
            continue
        try:
            faces = mesh.write_arrays(mesh_npz)
        except PartuvError as why:
            print(f"[{number}/{len(meshes)}] {mesh.name}: left out, {why}", flush=True)
            continue
        for tool in missing:
            record = partial(
                Result, mesh.name, digest, faces, tool.name, tool.version, limit_s=limit_s
            )
            try:
                python = environments.python(tool)
                made = run_tool(python, tool, mesh_npz, mesh.glb, atlas_npz, limit_s)
            except Unavailable as why:
                result = record(status="unavailable", message=str(why))
            except RunTimedOut as why:
                result = record(status="timeout", message=str(why))
            except RunFailed as why:
                result = record(status="failed", message=str(why))
            else:
                result = record(
                    status="ok",
                    seconds=made.seconds,
                    cpu_seconds=made.cpu_seconds,
                    peak_rss_mb=made.peak_rss_mb,
                    figures=judge(made.positions, made.faces, made.corner_uv),
                )
                if atlases is not None:
                    atlases.mkdir(parents=True, exist_ok=True)
                    shutil.copy(atlas_npz, atlases / f"{mesh.name} {tool.name}.npz")
            results.add(result)
            print(f"[{number}/{len(meshes)}] {mesh.name}, {tool.name}: {_told(result)}", flush=True)


def _told(result: Result) -> str:
    if result.figures is None or result.seconds is None:
        return f"{result.status}: {result.message}"
    return f"{result.figures.charts} charts in {result.seconds:.2f} s"
