"""The meshes of a run, as files and as what the tools get."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_worker.glb.scene import Scene
from partuv_worker.measure import welded

from bench.compare.shapes import SHAPES

Array = NDArray[Any]

OWN_SET = "own shapes"


@dataclass(frozen=True)
class MeshFile:
    name: str
    glb: Path

    @property
    def digest(self) -> str:
        return hashlib.sha256(self.glb.read_bytes()).hexdigest()[:16]

    def arrays(self) -> tuple[Array, Array]:
        """Positions (V x 3 float64), no two equal, and faces (F x 3 int32)."""
        soup = Scene(self.glb.read_bytes()).soup
        number = welded(soup.positions)
        positions = np.empty((int(number.max()) + 1, 3))
        positions[number] = soup.positions
        return positions, number[soup.faces].astype(np.int32)

    def write_arrays(self, path: Path) -> int:
        """Write the mesh for the tools' processes; returns how many faces it has."""
        positions, faces = self.arrays()
        np.savez(path, positions=positions, faces=faces)
        return len(faces)


def own_meshes(folder: Path) -> list[MeshFile]:
    """The shapes that the bench makes itself."""
    folder.mkdir(parents=True, exist_ok=True)
    meshes = []
    for name, make in SHAPES.items():
        path = folder / f"{name}.glb"
        if not path.exists():
            path.write_bytes(make())
        meshes.append(MeshFile(name, path))
    return meshes


def meshes_at(path: Path) -> list[MeshFile]:
    """The GLBs of a folder, by name, or the one GLB."""
    files = [path] if path.is_file() else sorted(path.glob("*.glb"))
    return [MeshFile(file.stem, file.resolve()) for file in files]
