"""What the reader makes of each way to store triangles."""

import numpy as np
import pytest
from partuv_contract.errors import (
    ExternalUriError,
    LimitError,
    MalformedGlbError,
    NonFinitePositionError,
    NoTrianglesError,
    UnsupportedError,
)
from partuv_worker.glb.limits import Limits
from partuv_worker.glb.scene import Scene

from tests.support.glb_builder import (
    TETRAHEDRON,
    TETRAHEDRON_FACES,
    GlbBuilder,
    grid,
    pack,
    tetrahedron,
)


def triangles(scene):
    return scene.soup.positions[scene.soup.faces]


def read(builder, limits=None):
    return Scene(builder.build(), limits or Limits())


def with_primitive(**parts):
    """A file with one primitive: positions and other members as arrays or JSON."""
    builder = GlbBuilder()
    primitive = {"attributes": {"POSITION": builder.positions(parts.pop("positions"))}}
    if "indices" in parts:
        primitive["indices"] = builder.accessor(parts.pop("indices"))
    builder.node(mesh=builder.mesh(primitive | parts))
    return builder


@pytest.mark.parametrize("kind", ["B", "H", "I"])
def test_indices_of_every_width(kind):
    builder = with_primitive(positions=TETRAHEDRON, indices=TETRAHEDRON_FACES.ravel().astype(kind))
    assert (triangles(read(builder)) == TETRAHEDRON[TETRAHEDRON_FACES]).all()


def test_no_indices():
    corners = TETRAHEDRON[TETRAHEDRON_FACES].reshape(-1, 3)
    assert (triangles(read(with_primitive(positions=corners))).reshape(-1, 3) == corners).all()


def test_strips_keep_one_orientation():
    positions = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0], [0, 2, 0]], "f")
    found = triangles(read(with_primitive(positions=positions, mode=5)))
    assert len(found) == 3
    normals = np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])
    assert (normals == [0, 0, 1]).all()


def test_fans_turn_about_their_first_vertex():
    positions = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], "f")
    scene = read(with_primitive(positions=positions, indices=np.array([0, 1, 2, 3], "B"), mode=6))
    assert (np.sort(scene.soup.faces, axis=1) == [[0, 1, 2], [0, 2, 3]]).all()
    found = triangles(scene)
    assert (np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0])[:, 2] > 0).all()


def test_an_incomplete_last_triangle_is_not_drawn():
    builder = with_primitive(positions=TETRAHEDRON, indices=np.array([0, 2, 1, 0, 1], "H"))
    assert len(read(builder).soup.faces) == 1


def test_interleaved_attributes():
    builder = GlbBuilder()
    vertices = np.concatenate([TETRAHEDRON, np.full((4, 3), 7, "f")], axis=1)
    view = builder.view(vertices.tobytes(), byteStride=24)
    common = {"bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3"}
    builder.json["accessors"] += [common, common | {"byteOffset": 12}]
    primitive = {
        "attributes": {"NORMAL": 1, "POSITION": 0},
        "indices": builder.accessor(TETRAHEDRON_FACES.ravel().astype("H")),
    }
    builder.node(mesh=builder.mesh(primitive))
    assert (triangles(read(builder)) == TETRAHEDRON[TETRAHEDRON_FACES]).all()


def test_sparse_positions():
    builder = tetrahedron()
    indices = builder.view(np.array([1, 3], "B").tobytes())
    values = builder.view(np.array([[2, 0, 0], [0, 0, 5]], "f").tobytes())
    builder.json["accessors"][0]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5121},
        "values": {"bufferView": values},
    }
    moved = TETRAHEDRON.copy()
    moved[[1, 3]] = [[2, 0, 0], [0, 0, 5]]
    assert (triangles(read(builder)) == moved[TETRAHEDRON_FACES]).all()
    del builder.json["accessors"][0]["bufferView"]  # then all others are zero
    moved[[0, 2]] = 0
    assert (triangles(read(builder)) == moved[TETRAHEDRON_FACES]).all()


@pytest.mark.parametrize(
    ("kind", "normalized", "divisor"),
    [("b", True, 127), ("B", True, 255), ("h", True, 32767), ("H", True, 65535), ("h", False, 1)],
)
def test_quantized_positions(kind, normalized, divisor):
    stored = (TETRAHEDRON * 100).astype(kind)
    builder = GlbBuilder()
    padded = np.zeros((4, 4), kind)
    padded[:, :3] = stored
    accessor = builder.accessor(padded, normalized=normalized)
    builder.json["accessors"][accessor]["type"] = "VEC3"
    builder.json["bufferViews"][0]["byteStride"] = 4 * padded.itemsize
    builder.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    primitive = {
        "attributes": {"POSITION": accessor},
        "indices": builder.accessor(TETRAHEDRON_FACES.ravel().astype("H")),
    }
    builder.node(mesh=builder.mesh(primitive))
    assert (triangles(read(builder)) == stored[TETRAHEDRON_FACES] / divisor).all()


def test_a_buffer_in_a_data_uri():
    scene = Scene(tetrahedron().data_uri())
    assert (triangles(scene) == TETRAHEDRON[TETRAHEDRON_FACES]).all()


def test_a_mesh_of_many_nodes_is_taken_once_where_it_stands_first():
    builder = tetrahedron()
    builder.json["nodes"][0]["scale"] = [2, 2, 2]
    builder.node(mesh=0, translation=[9, 9, 9])
    assert (triangles(read(builder)) == 2 * TETRAHEDRON[TETRAHEDRON_FACES]).all()


def test_mirrored_meshes_keep_their_outside():
    builder = tetrahedron()
    builder.json["nodes"][0]["scale"] = [-1, 1, 1]
    found = triangles(read(builder))
    volume = np.einsum("ij,ij->", found[:, 0], np.cross(found[:, 1], found[:, 2]))
    assert volume > 0
    assert found[..., 0].min() == -1


def test_a_mesh_scaled_to_nothing_is_judged_in_its_own_space():
    builder = tetrahedron()
    builder.json["nodes"][0]["scale"] = [0, 0, 0]
    builder.node(mesh=0, scale=[3, 3, 3])
    assert (triangles(read(builder)) == 3 * TETRAHEDRON[TETRAHEDRON_FACES]).all()
    builder.json["scenes"][0]["nodes"] = [0]
    assert (triangles(read(builder)) == TETRAHEDRON[TETRAHEDRON_FACES]).all()


def test_unused_vertices_are_not_part_of_the_soup():
    stray = np.concatenate([TETRAHEDRON, [[1e6, 1e6, 1e6]]]).astype("f")
    builder = with_primitive(positions=stray, indices=TETRAHEDRON_FACES.ravel().astype("H"))
    assert len(read(builder).soup.positions) == 4


def test_points_and_lines_are_no_triangles():
    builder = tetrahedron()
    for mode in range(4):
        builder.json["meshes"][0]["primitives"].append(
            {"attributes": {"POSITION": 0}, "indices": 1, "mode": mode}
        )
    assert len(read(builder).soup.faces) == 4
    del builder.json["meshes"][0]["primitives"][0]
    with pytest.raises(NoTrianglesError):
        read(builder)


def test_refuses_nan_and_names_the_accessor():
    for bad in (np.nan, np.inf):
        positions = TETRAHEDRON.copy()
        positions[2, 1] = bad
        builder = with_primitive(positions=positions, indices=np.arange(3, dtype="H"))
        for bound in ("min", "max"):
            del builder.json["accessors"][0][bound]
        with pytest.raises(NonFinitePositionError, match=r"accessor 0: .* vertex 2") as caught:
            read(builder)
        assert caught.value.pointer == "/accessors/0"


def test_refuses_positions_that_transforms_carry_to_infinity():
    builder = tetrahedron()
    builder.json["nodes"][0]["scale"] = [1e308, 1e308, 1e308]
    builder.json["nodes"][0]["translation"] = [1.7e308, 0, 0]
    with pytest.raises(MalformedGlbError, match="beyond all bounds"):
        read(builder)


def test_budgets_hold_before_anything_is_allocated():
    points, faces = grid(20, 20)
    builder = with_primitive(positions=points, indices=faces.ravel().astype("H"))
    assert read(builder, Limits(faces=800, vertices=441))
    for tight in (Limits(faces=799), Limits(vertices=440), Limits(decoded_bytes=441 * 12)):
        with pytest.raises(LimitError):
            read(builder, tight)


@pytest.mark.parametrize(
    ("path", "value", "error"),
    [
        ("accessors/0/count", 2**31, LimitError),
        ("accessors/0/count", 5, MalformedGlbError),
        ("accessors/0/count", 0, MalformedGlbError),
        ("accessors/0/count", True, MalformedGlbError),
        ("accessors/0/count", 3.5, MalformedGlbError),
        ("accessors/0/byteOffset", -12, MalformedGlbError),
        ("accessors/0/byteOffset", 2, MalformedGlbError),
        ("accessors/0/bufferView", 7, MalformedGlbError),
        ("accessors/0/componentType", 5124, MalformedGlbError),
        ("accessors/0/componentType", 5125, MalformedGlbError),
        ("accessors/0/type", "VEC2", MalformedGlbError),
        ("accessors/0/type", ["VEC3"], MalformedGlbError),
        ("accessors/1/componentType", 5122, MalformedGlbError),
        ("accessors/1/type", "VEC2", MalformedGlbError),
        ("accessors/1/normalized", True, MalformedGlbError),
        ("accessors/1/normalized", 1, MalformedGlbError),
        ("bufferViews/0/byteLength", 2**31, MalformedGlbError),
        ("bufferViews/0/byteOffset", 2**53, MalformedGlbError),
        ("bufferViews/0/buffer", 1, MalformedGlbError),
        ("bufferViews/0/byteStride", 8, MalformedGlbError),
        ("bufferViews/0/byteStride", 256, MalformedGlbError),
        ("meshes/0/primitives", [], MalformedGlbError),
        ("meshes/0/primitives/0/mode", 7, MalformedGlbError),
        ("meshes/0/primitives/0/indices", 9, MalformedGlbError),
        ("meshes/0/primitives/0/attributes", [0], MalformedGlbError),
        ("meshes/0/primitives/0/attributes/NORMAL", 1, MalformedGlbError),
        ("asset/version", "3.0", MalformedGlbError),
        ("asset/version", 2, MalformedGlbError),
        ("asset/minVersion", "2.1", MalformedGlbError),
        ("scene", 1, MalformedGlbError),
        ("extensionsRequired", ["ACME_secret"], UnsupportedError),
    ],
)
def test_refuses_what_the_specification_forbids(path, value, error):
    builder = tetrahedron()
    *parents, last = path.split("/")
    target = builder.json
    for key in parents:
        target = target[int(key) if isinstance(target, list) else key]
    target[int(last) if isinstance(target, list) else last] = value
    with pytest.raises(error) as caught:
        read(builder)
    assert caught.value.pointer is not None


@pytest.mark.parametrize(
    ("buffer", "error"),
    [
        ({"uri": "file:///etc/passwd"}, ExternalUriError),
        ({"uri": "http://localhost/x.bin"}, ExternalUriError),
        ({"uri": "../x.bin"}, ExternalUriError),
        ({"uri": "data:text/html;base64,AAAA"}, MalformedGlbError),
        ({"uri": "data:application/octet-stream;base64,####"}, MalformedGlbError),
        ({"byteLength": 4096}, MalformedGlbError),
    ],
)
def test_refuses_buffers_that_are_not_in_the_file(buffer, error):
    builder = tetrahedron()
    builder.json["buffers"] = [{"byteLength": len(builder.binary)} | buffer]
    with pytest.raises(error):
        read(builder)


def test_a_file_without_asset_is_refused():
    with pytest.raises(MalformedGlbError, match="'asset' is missing"):
        Scene(pack({}, None))
