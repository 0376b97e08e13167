"""The asset looks the same with its new UV set: rendered before and after by Filament."""

import importlib.util
import io
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from partuv_contract.options import UnwrapOptions
from partuv_worker.glb.scene import Scene
from partuv_worker.pipeline import unwrap_glb
from PIL import Image

from tests.support.glb_builder import GlbBuilder, grid
from tests.support.uv import separate_faces

RENDER = Path(__file__).parents[2] / "judges" / "render.py"
SMALLEST_STEP = 2  # of 255: rounding in the rasteriser


def picture(random, side=16):
    """A PNG of coloured squares."""
    pixels = random.integers(0, 255, (side, side, 3), dtype=np.uint8)
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()


def textured(second_set):
    """A bent sheet with four textures, a transform and a tangent space.

    second_set: the number of the UV set that half of the textures use.
    """
    random = np.random.default_rng(11)
    builder = GlbBuilder()
    points, faces = grid(12, 12)
    flat = points[:, :2] / 12
    points[:, 2] = 2 * np.sin(points[:, 0] / 3)
    slope = np.cos(points[:, 0] / 3) * 2 / 3
    length = np.sqrt(1 + slope**2)
    zero, one = np.zeros_like(slope), np.ones_like(slope)
    normals = np.stack([-slope / length, zero, 1 / length], axis=1).astype("f")
    tangents = np.stack([1 / length, zero, slope / length, one], axis=1).astype("f")
    images = [builder.view(picture(random)) for _ in range(4)]
    common = {
        "POSITION": builder.positions(points),
        "NORMAL": builder.accessor(normals),
        "TANGENT": builder.accessor(tangents),
        "TEXCOORD_0": builder.accessor(flat.astype("f")),
        "TEXCOORD_1": builder.accessor((1 - flat[:, ::-1] / 2).astype("f")),
    }
    halves = [builder.accessor(half.ravel().astype("H")) for half in (faces[:144], faces[144:])]
    builder.node(
        mesh=builder.mesh(
            {"attributes": common, "indices": halves[0], "material": 0},
            {"attributes": common, "indices": halves[1], "material": 1},
        )
    )
    turned = {"KHR_texture_transform": {"scale": [2, 3], "rotation": 0.5, "texCoord": second_set}}
    builder.json |= {
        "extensionsUsed": ["KHR_texture_transform", "KHR_materials_clearcoat"],
        "images": [{"bufferView": view, "mimeType": "image/png"} for view in images],
        "textures": [{"source": number} for number in range(4)],
        "materials": [
            {
                "doubleSided": True,
                "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0},
                "normalTexture": {"index": 1, "scale": 0.5},
                "emissiveTexture": {"index": 2, "texCoord": second_set},
                "emissiveFactor": [0.3, 0.3, 0.3],
            },
            {
                "doubleSided": True,
                "pbrMetallicRoughness": {
                    "baseColorTexture": {"index": 3, "texCoord": 0, "extensions": turned},
                    "metallicRoughnessTexture": {"index": 1, "texCoord": second_set},
                },
                "extensions": {
                    "KHR_materials_clearcoat": {
                        "clearcoatFactor": 1,
                        "clearcoatTexture": {"index": 2},
                    }
                },
            },
        ],
    }
    return builder.build()


def files():
    """Uploads and results. Filament knows two UV sets, so a third one must not be in use."""
    one_set, two_sets = textured(0), textured(1)
    one, two = Scene(one_set), Scene(two_sets)
    uv = separate_faces(len(one.soup.faces))
    return {
        "one set": one_set,
        "two sets": two_sets,
        "kept": one.write(uv, "keep"),
        "appended": two.write(uv, "append"),
        "compressed": one.write(uv, "keep", compress="meshopt"),
        "replaced": one.write(uv, "replace"),
        "repacked": unwrap_glb(one_set, UnwrapOptions(mode="repack")).glb,
    }


@pytest.fixture(scope="module")
def pictures(tmp_path_factory):
    """What each file looks like."""
    if importlib.util.find_spec("filly") is None:
        pytest.skip("the renderer is not installed (filly)")
    folder = tmp_path_factory.mktemp("rendered")
    named = files()
    paths = [folder / f"{name}.glb" for name in named]
    for path, content in zip(paths, named.values(), strict=True):
        path.write_bytes(content)
    arguments = [sys.executable, str(RENDER), str(folder / "pictures.npy"), *map(str, paths)]
    finished = subprocess.run(arguments, capture_output=True, text=True, timeout=200)
    if finished.returncode:
        pytest.skip(f"the renderer found no OpenGL driver: {finished.stderr[-200:]}")
    return dict(zip(named, np.load(folder / "pictures.npy").astype(int), strict=True))


def differing(first, second):
    return (np.abs(first - second).max(axis=-1) > SMALLEST_STEP).sum()


@pytest.mark.parametrize(
    ("upload", "result"),
    [
        ("one set", "kept"),
        ("two sets", "appended"),
        ("one set", "compressed"),
        ("one set", "repacked"),
    ],
)
def test_the_picture_does_not_change(pictures, upload, result):
    assert len(np.unique(pictures[upload].reshape(-1, 4), axis=0)) > 1000
    assert differing(pictures[upload], pictures[result]) == 0


def test_the_picture_would_show_a_difference(pictures):
    assert differing(pictures["one set"], pictures["replaced"]) > 1000
