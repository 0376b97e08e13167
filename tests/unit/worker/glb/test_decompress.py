"""Draco and meshopt streams, made here by the libraries' encoders."""

import DracoPy
import meshopt
import numpy as np
import pytest
from partuv_contract.errors import LimitError, MalformedGlbError, UnsupportedError
from partuv_worker.glb.limits import Limits
from partuv_worker.glb.scene import Scene

from tests.support.glb_builder import GlbBuilder, grid
from tests.support.glb_parse import ParsedGlb
from tests.support.uv import separate_faces

DRACO = "KHR_draco_mesh_compression"
POINTS, FACES = grid(7, 5)
HEAT = np.arange(len(POINTS), dtype=np.float32)[:, None]
TRIANGLES = POINTS[FACES]


def draco_file(stream=None, **json):
    """A grid as a Draco primitive with a custom attribute of id 7."""
    builder = GlbBuilder()
    stream = stream or DracoPy.encode(
        POINTS, FACES, quantization_bits=20, preserve_order=True, generic_attributes={7: HEAT}
    )
    decoded = DracoPy.decode(stream)
    ids = [a["unique_id"] for a in decoded.attributes if a["unique_id"] != 7]
    view = builder.view(stream)
    count = len(POINTS)
    builder.json["accessors"] = [
        {"componentType": 5126, "count": count, "type": "VEC3", "min": [0, 0, 0], "max": [7, 5, 0]},
        {"componentType": 5126, "count": count, "type": "SCALAR"},
        {"componentType": 5123, "count": FACES.size, "type": "SCALAR"},
    ]
    declared = {"bufferView": view, "attributes": {"POSITION": ids[0], "_HEAT": 7}}
    primitive = {
        "attributes": {"POSITION": 0, "_HEAT": 1},
        "indices": 2,
        "extensions": {DRACO: declared},
    }
    builder.node(mesh=builder.mesh(primitive))
    builder.json |= {"extensionsUsed": [DRACO], "extensionsRequired": [DRACO], **json}
    return builder


def meshopt_file(name="EXT_meshopt_compression", stride=16):
    """A grid whose positions and indices are meshopt views, with a fallback buffer."""
    padded = np.zeros((len(POINTS), stride // 4), np.float32)
    padded[:, :3] = POINTS
    builder = GlbBuilder()
    builder.json["buffers"] = [{}, {"byteLength": padded.nbytes + FACES.size * 4}]
    streams = (
        (meshopt.encode_gltf_buffer(padded, "ATTRIBUTES"), len(POINTS), stride, "ATTRIBUTES"),
        (
            meshopt.encode_gltf_buffer(FACES.ravel().astype("I"), "TRIANGLES"),
            FACES.size,
            4,
            "TRIANGLES",
        ),
    )
    offset = 0
    for stream, count, size, mode in streams:
        start = len(builder.binary)
        builder.binary += stream + bytes(-len(stream) % 4)
        declared = {
            "buffer": 0,
            "byteOffset": start,
            "byteLength": len(stream),
            "byteStride": size,
            "count": count,
            "mode": mode,
        }
        view = {
            "buffer": 1,
            "byteOffset": offset,
            "byteLength": count * size,
            "extensions": {name: declared},
        }
        offset += count * size
        builder.json["bufferViews"].append(view | ({"byteStride": size} if size > 4 else {}))
    builder.json["buffers"][0] = {"byteLength": len(builder.binary)}
    builder.json["accessors"] = [
        {
            "bufferView": 0,
            "componentType": 5126,
            "count": len(POINTS),
            "type": "VEC3",
            "min": [0, 0, 0],
            "max": [7, 5, 0],
        },
        {"bufferView": 1, "componentType": 5125, "count": FACES.size, "type": "SCALAR"},
    ]
    builder.node(mesh=builder.mesh({"attributes": {"POSITION": 0}, "indices": 1}))
    builder.json |= {"extensionsUsed": [name], "extensionsRequired": [name]}
    return builder


def sorted_rows(triangles):
    """Triangles in an order of their own, each turned to start at its lowest corner."""
    flat = np.array(
        [
            min((np.roll(t, k, axis=0) for k in range(3)), key=lambda a: a.tobytes())
            for t in triangles
        ]
    ).reshape(-1, 9)
    return flat[np.lexsort(flat.T)]


def test_draco_triangles_and_attributes_come_out():
    scene = Scene(draco_file().build())
    found = scene.soup.positions[scene.soup.faces]
    assert np.allclose(sorted_rows(found.round(3)), sorted_rows(TRIANGLES), atol=1e-3)
    after = ParsedGlb(scene.write(separate_faces(len(FACES))))
    assert "extensionsUsed" not in after.json
    assert "extensionsRequired" not in after.json
    assert "extensions" not in after.primitive()
    heat = after.corners("_HEAT")[..., 0]
    where = np.rint(after.corners("POSITION")).astype(int)
    assert (heat == where[..., 1] * 8 + where[..., 0]).all()
    assert len(after.json["bufferViews"]) == 4  # the stream itself is gone


def test_draco_beside_plain_arrays_is_dropped_for_them():
    builder = draco_file()
    plain = [
        builder.accessor(POINTS),
        builder.accessor(HEAT),
        builder.accessor(FACES.ravel().astype("H")),
    ]
    for index, accessor in enumerate(plain):
        view = builder.json["accessors"][accessor]["bufferView"]
        builder.json["accessors"][index]["bufferView"] = view
    del builder.json["extensionsRequired"]
    scene = Scene(builder.build())
    assert (scene.soup.positions[scene.soup.faces] == TRIANGLES).all()


def test_one_accessor_may_serve_two_draco_streams():
    builder = draco_file()
    other = DracoPy.encode(POINTS + 100, FACES, quantization_bits=20, generic_attributes={7: HEAT})
    primitive = builder.json["meshes"][0]["primitives"][0]
    declared = primitive["extensions"][DRACO] | {"bufferView": builder.view(other)}
    builder.json["meshes"][0]["primitives"].append(primitive | {"extensions": {DRACO: declared}})
    scene = Scene(builder.build())
    assert scene.soup.positions[scene.soup.faces[: len(FACES)]].max() < 10
    assert scene.soup.positions[scene.soup.faces[len(FACES) :]].min() > 90


@pytest.mark.parametrize("name", ["EXT_meshopt_compression", "KHR_meshopt_compression"])
def test_meshopt_views_become_plain(name):
    scene = Scene(meshopt_file(name).build())
    found = scene.soup.positions[scene.soup.faces]
    assert (sorted_rows(found) == sorted_rows(TRIANGLES)).all()
    after = ParsedGlb(scene.write(separate_faces(len(FACES))))
    assert "extensionsRequired" not in after.json
    assert len(after.json["buffers"]) == 1
    assert all("extensions" not in view for view in after.json["bufferViews"])


def edited(builder, path, value):
    *parents, last = path.split("/")
    target = builder.json
    for key in parents:
        target = target[int(key) if isinstance(target, list) else key]
    target[last] = value
    return builder.build()


DECLARED = f"meshes/0/primitives/0/extensions/{DRACO}"


@pytest.mark.parametrize(
    ("path", "value", "error"),
    [
        ("accessors/2/count", FACES.size + 3, MalformedGlbError),
        ("accessors/2/count", 2, MalformedGlbError),
        ("accessors/0/count", len(POINTS) + 1, MalformedGlbError),
        ("accessors/0/count", 2**40, MalformedGlbError),
        ("accessors/0/type", "VEC2", MalformedGlbError),
        ("accessors/0/type", "MAT4", MalformedGlbError),
        ("accessors/0/componentType", 5123, MalformedGlbError),
        (f"{DECLARED}/bufferView", 9, MalformedGlbError),
        (f"{DECLARED}/attributes", {"POSITION": 55}, MalformedGlbError),
        (f"{DECLARED}/attributes", {"NORMAL": 0}, MalformedGlbError),
        (f"{DECLARED}/attributes", {"POSITION": "x"}, MalformedGlbError),
        ("meshes/0/primitives/0/mode", 5, UnsupportedError),
    ],
)
def test_refuses_draco_that_does_not_fit_its_accessors(path, value, error):
    with pytest.raises(error) as caught:
        Scene(edited(draco_file(), path, value))
    assert caught.value.pointer


@pytest.mark.parametrize("cut", [0, 4, 7, 12, 20, 60, -1])
def test_refuses_draco_streams_that_break_off(cut):
    builder = draco_file()
    builder.json["bufferViews"][0]["byteLength"] = max(
        cut if cut >= 0 else builder.json["bufferViews"][0]["byteLength"] - 20, 1
    )
    with pytest.raises(MalformedGlbError, match="Draco stream"):
        Scene(builder.build())


def test_a_draco_header_that_lies_is_caught_before_decoding(monkeypatch):
    stream = bytearray(DracoPy.encode(POINTS, FACES, generic_attributes={7: HEAT}))
    builder = draco_file(bytes(stream))
    position = builder.binary.index(b"DRACO")
    lying = bytearray(builder.binary)
    lying[position + 13 : position + 18] = b"\xff\xff\xff\xff\x0f"  # 2^32 - 1 triangles
    builder.binary = bytes(lying)
    monkeypatch.setattr(DracoPy, "decode", lambda stream: pytest.fail("reached the decoder"))
    with pytest.raises(MalformedGlbError):
        Scene(builder.build())


@pytest.mark.parametrize(
    ("key", "value", "error"),
    [
        ("count", 2**30, MalformedGlbError),
        ("count", 0, MalformedGlbError),
        ("byteStride", 3, MalformedGlbError),
        ("byteStride", 260, MalformedGlbError),
        ("mode", "POINTS", MalformedGlbError),
        ("mode", "TRIANGLES", MalformedGlbError),
        ("filter", "BLUR", MalformedGlbError),
        ("filter", "QUATERNION", MalformedGlbError),
        ("byteLength", 5, MalformedGlbError),
        ("byteLength", 2**31, MalformedGlbError),
        ("buffer", 1, MalformedGlbError),
        ("buffer", 2, MalformedGlbError),
    ],
)
def test_refuses_meshopt_that_contradicts_itself(key, value, error):
    path = f"bufferViews/0/extensions/EXT_meshopt_compression/{key}"
    with pytest.raises(error) as caught:
        Scene(edited(meshopt_file(), path, value))
    assert caught.value.pointer


def test_streams_may_not_grow_beyond_the_limits():
    for tight in (Limits(expansion=1), Limits(decoded_bytes=500)):
        for builder in (meshopt_file(), draco_file()):
            with pytest.raises(LimitError):
                Scene(builder.build(), tight)


def test_a_meshopt_bomb_is_refused_without_decoding(monkeypatch):
    builder = meshopt_file()
    builder.json["bufferViews"][0]["byteLength"] = 2**20 * 16
    path = "bufferViews/0/extensions/EXT_meshopt_compression/count"
    monkeypatch.setattr(meshopt, "decode_gltf_buffer", lambda *_: pytest.fail("decoded"))
    with pytest.raises(LimitError, match="claim to hold"):
        Scene(edited(builder, path, 2**20))


def several_kinds():
    """A grid with attributes of each kind, a shared one and a signed one, and a morph target."""
    random = np.random.default_rng(3)
    count = len(POINTS)
    builder = GlbBuilder()
    attributes = {
        "POSITION": builder.positions(POINTS + random.normal(size=POINTS.shape).astype("f")),
        "NORMAL": builder.accessor(random.normal(size=(count, 3)).astype("f")),
        "TEXCOORD_0": builder.accessor(random.random((count, 2)).astype("f")),
        "COLOR_0": builder.accessor(
            random.integers(0, 255, (count, 4)).astype("B"), normalized=True
        ),
        "JOINTS_0": builder.accessor(random.integers(0, 4, (count, 4)).astype("H")),
        "_SIGNED": builder.accessor(random.integers(-9, 9, (count, 2)).astype("h")),
    }
    target = {"POSITION": builder.accessor(random.normal(size=(count, 3)).astype("f"))}
    indices = builder.accessor(FACES.ravel().astype("H"))
    builder.node(
        mesh=builder.mesh({"attributes": attributes, "indices": indices, "targets": [target]})
    )
    return builder


def test_a_result_can_be_stored_as_draco_to_the_bit():
    scene = Scene(several_kinds().build())
    uv = separate_faces(len(FACES))
    plain, packed = ParsedGlb(scene.write(uv)), ParsedGlb(scene.write(uv, compress="draco"))
    primitive = packed.primitive()
    declared = primitive["extensions"][DRACO]
    assert set(declared["attributes"]) == set(primitive["attributes"]) - {"_SIGNED"}
    assert DRACO in packed.json["extensionsRequired"]
    decoded = DracoPy.decode(packed.view(declared["bufferView"]))
    indices = plain.array(plain.primitive()["indices"]).reshape(-1, 3)
    assert np.array_equal(decoded.faces, indices)
    data = {entry["unique_id"]: entry["data"] for entry in decoded.attributes}
    for name, index in plain.primitive()["attributes"].items():
        wanted = plain.array(index)
        if name == "_SIGNED":
            found = packed.array(primitive["attributes"][name])
        else:
            accessor = packed.json["accessors"][primitive["attributes"][name]]
            assert "bufferView" not in accessor
            found = data[declared["attributes"][name]].reshape(wanted.shape).astype(wanted.dtype)
        assert found.tobytes() == wanted.tobytes(), name
    assert np.array_equal(
        packed.array(primitive["targets"][0]["POSITION"]),
        plain.array(plain.primitive()["targets"][0]["POSITION"]),
    )


def test_a_draco_result_is_read_again():
    scene = Scene(several_kinds().build())
    uv = separate_faces(len(FACES))
    again = Scene(scene.write(uv, compress="draco"))
    assert np.array_equal(again.soup.positions[again.soup.faces], scene.soup.positions[FACES])
    assert np.allclose(again.existing_uv(), uv - (0, 1), atol=1e-7)
    wanted, found = ParsedGlb(scene.write(uv)), ParsedGlb(again.write(uv, "replace"))
    for name in ("NORMAL", "COLOR_0", "JOINTS_0", "_SIGNED", "TEXCOORD_1"):
        assert np.array_equal(found.corners(name), wanted.corners(name)), name


def test_what_primitives_share_is_not_stored_as_draco():
    builder = several_kinds()
    primitives = builder.json["meshes"][0]["primitives"]
    primitives.append(dict(primitives[0]))
    scene = Scene(builder.build())
    written = ParsedGlb(scene.write(separate_faces(2 * len(FACES)), compress="draco"))
    assert "extensionsUsed" not in written.json
