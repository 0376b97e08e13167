"""What the benches of the engine alone have in common."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import partuv_engine
from numpy.typing import NDArray

from bench.compare.meshes import MeshFile, meshes_at


def unwrapped(positions: NDArray[Any], faces: NDArray[Any]) -> partuv_engine.Atlas:
    """The engine's atlas by default options, with all processors."""
    return partuv_engine.unwrap(
        np.ascontiguousarray(positions, np.float64),
        np.ascontiguousarray(faces, np.int32),
        partuv_engine.Options(),
        partuv_engine.Context(threads=os.cpu_count() or 1),
    )


def mesh_parser(name: str, description: str) -> argparse.ArgumentParser:
    """A command line that takes meshes."""
    parser = argparse.ArgumentParser(
        prog=name, description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("meshes", nargs="+", type=Path, help="GLBs or folders of them")
    return parser


def named_meshes(paths: Sequence[Path]) -> list[MeshFile]:
    """The meshes that a command line names; ends the program if there are none."""
    meshes = [mesh for path in paths for mesh in meshes_at(path)]
    if not meshes:
        sys.exit(f"no GLB in {', '.join(map(str, paths))}")
    return meshes
