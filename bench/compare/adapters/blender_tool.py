"""Blender's Smart UV Project, at 66 degrees as in its menu."""

from __future__ import annotations

import math

import bpy
import numpy as np

from bench.compare.adapters.blender_mesh import edited_uv
from bench.compare.adapters.exchange import Atlas, Mesh, answer


def unwrap(mesh: Mesh, arguments: list[str]) -> Atlas:
    def smart_project() -> None:
        bpy.ops.uv.smart_project(angle_limit=math.radians(66), island_margin=0.003)

    blank = np.zeros((len(mesh.faces), 3, 2))
    return Atlas(edited_uv(mesh.positions, mesh.faces, blank, smart_project))


if __name__ == "__main__":
    answer(unwrap)
