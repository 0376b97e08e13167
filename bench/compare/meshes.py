"""The meshes of a run, as files and as what the tools get."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from partuv_worker.glb.scene import Scene
from partuv_worker.measure import welded

from bench.compare.shapes import SHAPES

OWN_SET = "own shapes"


@dataclass(frozen=True)
class MeshFile:
    name: str
    glb: Path

    @property
    def digest(self) -> str:
        return hashlib.sha256(self.glb.read_bytes()).hexdigest()[:16]

    def write_arrays(self, path: Path) -> int:
        """Write the mesh for the tools' processes, equal positions welded; returns its faces."""
        soup = Scene(self.glb.read_bytes()).soup
        number = welded(soup.positions)
        positions = np.empty((int(number.max()) + 1, 3))
        positions[number] = soup.positions
        faces = number[soup.faces].astype(np.int32)
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


def meshes_in(folder: Path) -> list[MeshFile]:
    """The GLBs of a folder, by name."""
    return [MeshFile(path.stem, path.resolve()) for path in sorted(folder.glob("*.glb"))]
