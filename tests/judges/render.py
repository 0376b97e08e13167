"""Render GLB files with Filament: `python render.py OUT.npy FILE...` writes N x H x W x 4 bytes.

A process of its own, because a renderer without a usable OpenGL driver may end its process.
"""

import sys

import filly
import numpy as np

SIZE_PIXELS = 200
LIGHTS = (((-1, -1, -2), 100_000), ((1, 0.5, 1), 40_000))


def render(renderer: filly.Renderer, path: str) -> np.ndarray:
    """The picture of one file, seen from a corner."""
    scene = renderer.create_scene()
    model = scene.load(path)
    scene.camera = renderer.create_camera()
    scene.camera.frame(model, direction=(-1, -0.4, -1.5))
    for direction, intensity in LIGHTS:
        scene.add_directional_light(direction=direction, intensity=intensity)
    target = renderer.create_render_target(width=SIZE_PIXELS, height=SIZE_PIXELS)
    renderer.render(scene, target)
    return target.read().copy()


if __name__ == "__main__":
    with filly.Renderer() as shared:
        np.save(sys.argv[1], np.stack([render(shared, path) for path in sys.argv[2:]]))
