"""Readers that are not ours find nothing in a result that they did not find in the upload.

The Khronos validator and three.js run under node (`npm install --prefix tests/judges`).
"""

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import partuv_worker.samples
import pygltflib
import pytest
import trimesh
from partuv_contract.options import UnwrapOptions
from partuv_worker.glb.scene import Scene
from partuv_worker.pipeline import unwrap_glb

from tests.support.glb_builder import GlbBuilder, grid, tetrahedron
from tests.support.glb_parse import ParsedGlb
from tests.support.patches import patch_builder, patches
from tests.support.uv import separate_faces
from tests.unit.worker.glb.test_decompress import draco_file, meshopt_file
from tests.unit.worker.glb.test_writing import rich_grid

JUDGES = Path(__file__).parents[2] / "judges"
CORPORA = Path(__file__).parents[4] / "shared" / "meshes"
ROBOT = Path(partuv_worker.samples.__file__).with_name("robot.glb")
NODE = shutil.which("node")
HAS_JUDGES = NODE is not None and (JUDGES / "node_modules").is_dir()


def instanced():
    """One mesh in three places, one of them mirrored."""
    builder = tetrahedron()
    builder.node(mesh=0, translation=[3, 0, 0])
    builder.node(mesh=0, scale=[-1, 1, 1], translation=[0, 3, 0])
    return builder


def strip():
    points, _ = grid(1, 9)
    builder = GlbBuilder()
    primitive = {"attributes": {"POSITION": builder.positions(points)}, "mode": 5}
    builder.node(mesh=builder.mesh(primitive))
    return builder


def uploads():
    """Name and bytes of files that hold every feature."""
    made = (rich_grid, draco_file, meshopt_file, instanced, strip, tetrahedron)
    found = {builder.__name__: builder().build() for builder in made}
    found["robot"] = ROBOT.read_bytes()
    found["data_uri"] = tetrahedron().data_uri()
    for folder, pattern in (("manmade", "*.glb"), ("malformed", "ok_*.glb")):
        for path in sorted((CORPORA / folder).glob(pattern)):
            found[f"{folder}/{path.stem}"] = path.read_bytes()
    return found


def results():
    """(name, upload, result, triangles drawn) for every way to write."""
    for name, data in uploads().items():
        if "primitivemode_00" in name or "primitivemode_02" in name:
            continue  # points and lines only
        scene = Scene(data)
        uv = separate_faces(len(scene.soup.faces))
        ways = ["keep"] if "/" in name else ["keep", "append", "replace"]
        for way in ways:
            yield f"{name} {way}", data, scene.write(uv, way)
        yield f"{name} compressed", data, scene.write(uv, compress="meshopt")
        if "/" not in name:
            yield f"{name} as Draco", data, scene.write(uv, compress="draco")
    data = patch_builder(patches(1, 8)).build()
    yield "repacked", data, unwrap_glb(data, UnwrapOptions(mode="repack")).glb


@pytest.fixture(scope="module")
def written():
    return list(results())


@pytest.fixture(scope="module")
def judged(written, tmp_path_factory):
    """What node's judges say of uploads and results, by name."""
    folder = tmp_path_factory.mktemp("judged")
    paths = {}
    for number, (name, upload, result) in enumerate(written):
        for kind, data in (("upload", upload), ("result", result)):
            path = folder / f"{number}-{kind}.glb"
            path.write_bytes(data)
            paths[str(path)] = (name, kind)
    arguments = [NODE, str(JUDGES / "judge.mjs"), *paths]
    told = subprocess.run(arguments, capture_output=True, text=True, timeout=300, check=True)
    verdicts = {}
    for line in told.stdout.splitlines():
        if line.startswith('{"path"'):
            verdict = json.loads(line)
            name, kind = paths[verdict["path"]]
            verdicts.setdefault(name, {})[kind] = verdict
    assert len(verdicts) == len(paths) // 2
    return verdicts


@pytest.mark.skipif(not HAS_JUDGES, reason="needs node, and `npm install --prefix tests/judges`")
def test_the_validator_finds_no_new_error(judged):
    for name, verdict in judged.items():
        before, after = (set(verdict[kind]["issues"]) for kind in ("upload", "result"))
        new = {issue for issue in after - before if issue.startswith(("0", "1"))}
        assert not new, f"{name}: {new}"


@pytest.mark.skipif(not HAS_JUDGES, reason="needs node, and `npm install --prefix tests/judges`")
def test_three_loads_as_many_triangles_and_finds_the_atlas(judged):
    for name, verdict in judged.items():
        assert "threeFailed" not in verdict["result"], f"{name}: {verdict['result']}"
        result = verdict["result"]["three"]
        assert result["triangles"] == result["withAtlas"] > 0, name
        if "threeFailed" not in verdict["upload"]:
            assert result["triangles"] == verdict["upload"]["three"]["triangles"], name


def drawn(data):
    """Triangles of each primitive that the default scene draws, once for every instance."""
    json = ParsedGlb(data).json
    nodes = list(json["scenes"][json.get("scene", 0)]["nodes"])
    while nodes:
        node = json["nodes"][nodes.pop()]
        nodes += node.get("children", [])
        for primitive in json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
            if primitive.get("mode", 4) == 4:
                drawing = primitive.get("indices", primitive["attributes"]["POSITION"])
                yield json["accessors"][drawing]["count"] // 3


def test_trimesh_and_pygltflib_load_as_many_triangles(written):
    for name, _, result in written:
        if name.endswith("compressed"):
            continue  # neither knows meshopt
        loaded = trimesh.load(trimesh.util.wrap_as_stream(result), file_type="glb", process=False)
        shown = (loaded.geometry[loaded.graph[node][1]] for node in loaded.graph.nodes_geometry)
        faces = sum(len(mesh.faces) for mesh in shown if isinstance(mesh, trimesh.Trimesh))
        assert faces == sum(drawn(result)), name
        assert np.isfinite(loaded.bounds).all(), name


def test_pygltflib_reads_what_it_knows_and_finds_the_atlas(written):
    for name, _, result in written:
        if "/" in name:
            continue  # slow on large documents
        document = pygltflib.GLTF2.load_from_bytes(result)
        assert document.binary_blob() is not None
        for mesh in document.meshes:
            for primitive in mesh.primitives:
                accessor = document.accessors[primitive.attributes.TEXCOORD_0]
                assert accessor.count == document.accessors[primitive.attributes.POSITION].count
