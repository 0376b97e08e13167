"""A mesh in Blender, with UVs that its operators work on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def edited_uv(positions: Array, faces: Array, uv: Array, operate: Callable[[], object]) -> Array:
    """UVs per corner (F x 3 x 2) after an operator of the edit mode; all faces are selected."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    mesh = bpy.data.meshes.new("mesh")
    mesh.from_pydata(positions.tolist(), [], faces.tolist())
    layer = mesh.uv_layers.new(name="uv")
    layer.data.foreach_set("uv", uv.astype(np.float32).ravel())
    scene_object = bpy.data.objects.new("object", mesh)
    bpy.context.scene.collection.objects.link(scene_object)
    bpy.context.view_layer.objects.active = scene_object
    scene_object.select_set(True)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.context.scene.tool_settings.use_uv_select_sync = True
    bpy.ops.mesh.select_all(action="SELECT")
    operate()
    bpy.ops.object.mode_set(mode="OBJECT")
    result = np.empty(6 * len(faces), np.float32)
    mesh.uv_layers[0].data.foreach_get("uv", result)
    return result.reshape(-1, 3, 2)
