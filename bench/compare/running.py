"""One tool on one mesh, in a process of its own with a time limit."""

from __future__ import annotations

import os
import signal
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.compare.tools import Tool

Array = NDArray[Any]

REPOSITORY = Path(__file__).parents[2]
_STARTING_S = 30.0  # for the interpreter and the tool's imports, on top of the limit


@dataclass(frozen=True)
class Unwrapped:
    positions: Array  # V x 3
    faces: Array  # F x 3
    corner_uv: Array  # F x 3 x 2
    seconds: float
    cpu_seconds: float
    peak_rss_mb: float


class RunFailed(Exception):
    """A tool gave no atlas; the message is its last word."""


class RunTimedOut(RunFailed):
    """A tool was stopped at the limit."""


def run_tool(
    python: Path, tool: Tool, mesh_npz: Path, mesh_glb: Path, atlas_npz: Path, limit_s: float
) -> Unwrapped:
    """Unwrap a mesh; raises `RunFailed` or `RunTimedOut`."""
    atlas_npz.unlink(missing_ok=True)
    process = subprocess.Popen(
        [python, "-m", tool.module, mesh_npz, mesh_glb, atlas_npz, *tool.arguments],
        cwd=REPOSITORY,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        start_new_session=True,
    )
    try:
        said, _ = process.communicate(timeout=limit_s + _STARTING_S)
    except subprocess.TimeoutExpired:
        raise RunTimedOut(f"no result after {limit_s:g} s") from None
    finally:
        _end(process)
    if process.returncode or not atlas_npz.exists():
        raise RunFailed(_last_words(said, process.returncode))
    return _read(atlas_npz)


def _end(process: subprocess.Popen[str]) -> None:
    """Kill what is left of the process and of those that it started."""
    if process.poll() is None:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


def _last_words(said: str, code: int) -> str:
    if code < 0:
        return f"killed by {signal.Signals(-code).name}"
    lines = [line.strip() for line in said.splitlines() if line.strip()]
    return lines[-1][:200] if lines else f"exit code {code}"


def _read(path: Path) -> Unwrapped:
    with np.load(path) as stored:
        uv = stored["corner_uv"].astype(np.float64)
        if not np.isfinite(uv).all():
            raise RunFailed("UVs that are not finite")
        return Unwrapped(
            stored["positions"],
            stored["faces"],
            uv,
            float(stored["seconds"]),
            float(stored["cpu_seconds"]),
            float(stored["peak_rss_mb"]),
        )
