"""Import assets into Blender before and after, and compare triangles and pictures.

`python bench/blender_check.py BEFORE_FOLDER AFTER_FOLDER` in an environment with `bpy` (PyPI).
Cycles knows any number of UV sets, so that it also judges assets that had two sets already.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

import bpy
import mathutils
import numpy as np

SIZE_PIXELS = 128
SMALLEST_STEP = 4 / 255  # rounding of shading


def load(path: Path) -> int:
    """Import a file into an empty scene; returns its number of triangles."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.import_scene.gltf(filepath=str(path))
    meshes = [item.data for item in bpy.context.scene.objects if item.type == "MESH"]
    return sum(len(polygon.vertices) - 2 for mesh in meshes for polygon in mesh.polygons)


def look_from_a_corner() -> None:
    """Put a camera where it sees everything, and even light around."""
    scene = bpy.context.scene
    bpy.context.view_layer.update()
    corners = np.array(
        [
            item.matrix_world @ mathutils.Vector(corner)
            for item in scene.objects
            if item.type == "MESH"
            for corner in item.bound_box
        ]
    )
    center, radius = corners.mean(axis=0), np.ptp(corners, axis=0).max()
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 1.6 * radius
    camera.data.clip_end = 100 * radius
    camera.location = center + radius * np.array([3.0, -4.0, 2.0])
    direction = mathutils.Vector(center) - camera.location
    camera.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("light")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)


def picture() -> np.ndarray:
    """The scene as Cycles renders it with one fixed sample per pixel."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.seed = 1
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x = scene.render.resolution_y = SIZE_PIXELS
    with tempfile.TemporaryDirectory() as folder:
        scene.render.filepath = str(Path(folder) / "picture.png")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(scene.render.filepath)
        pixels = np.array(image.pixels[:]).reshape(SIZE_PIXELS, SIZE_PIXELS, 4)
        bpy.data.images.remove(image)
    return pixels


def check(before: Path, after: Path) -> dict[str, object]:
    """One line about a pair of files."""
    seen = []
    for path in (before, after):
        triangles = load(path)
        look_from_a_corner()
        seen.append((triangles, picture()))
    (wanted, first), (found, second) = seen
    differing = int((np.abs(first - second).max(axis=-1) > SMALLEST_STEP).sum())
    return {"triangles": wanted, "triangles_after": found, "differing_pixels": differing}


if __name__ == "__main__":
    folders = [Path(argument) for argument in sys.argv[1:3]]
    for result in sorted(folders[1].glob("*.glb")):
        try:
            line = check(folders[0] / result.name, result)
        except RuntimeError as failure:
            line = {"failed": str(failure).strip()[-200:]}
        print(json.dumps({"file": result.name} | line), flush=True)
