"""What comes back: the client's own file with one more UV set."""

import copy

import numpy as np
import pytest
from partuv_worker.glb.scene import Scene

from tests.support.glb_builder import TETRAHEDRON, TETRAHEDRON_FACES, GlbBuilder, grid, tetrahedron
from tests.support.glb_parse import ParsedGlb
from tests.support.uv import seamless, separate_faces


def unwrap(data, uv_of=separate_faces, existing_uv="keep"):
    """Write UVs into a file; returns the parsed result and the UVs per corner, V down."""
    scene = Scene(data)
    uv = uv_of(len(scene.soup.faces))
    written = scene.write(uv, existing_uv)
    Scene(written)  # our own reader accepts it
    flipped = uv.copy()
    flipped[..., 1] = 1 - flipped[..., 1]
    return ParsedGlb(written), flipped


def one_patch(_):
    """UVs of a grid without any seam."""
    points, faces = grid(6, 5)
    return seamless(points, faces)


def rich_grid():
    """A grid with every kind of attribute, a morph target, and things beside the mesh."""
    points, faces = grid(6, 5)
    count = len(points)
    ramp = np.arange(count)
    builder = GlbBuilder()
    image = builder.view(b"not really a PNG!")
    primitive = {
        "attributes": {
            "POSITION": builder.positions(points),
            "NORMAL": builder.accessor(np.tile(np.array([0, 0, 1], "f"), (count, 1))),
            "TANGENT": builder.accessor(np.tile(np.array([1, 0, 0, 1], "f"), (count, 1))),
            "TEXCOORD_0": builder.accessor(points[:, :2] / 8),
            "TEXCOORD_1": builder.accessor(
                (points[:, :2] * 9).astype("H"), normalized=True, name="light"
            ),
            "COLOR_0": builder.accessor(np.repeat(ramp, 4).reshape(-1, 4).astype("B")),
            "JOINTS_0": builder.accessor(np.repeat(ramp, 4).reshape(-1, 4).astype("H")),
            "WEIGHTS_0": builder.accessor(np.repeat(ramp / 64, 4).reshape(-1, 4).astype("f")),
            "_HEAT": builder.accessor(ramp.astype("f")),
        },
        "targets": [{"POSITION": builder.positions(points[:, ::-1].copy())}],
        "indices": builder.accessor(faces.ravel().astype("H")),
        "material": 0,
    }
    builder.node(mesh=builder.mesh(primitive, name="plate", weights=[0.5]), extras={"id": 7})
    builder.json |= {
        "images": [{"bufferView": image, "mimeType": "image/png"}],
        "textures": [{"source": 0}],
        "materials": [{"name": "skin", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "animations": [
            {
                "channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}],
                "samplers": [
                    {
                        "input": builder.accessor(np.array([0, 1], "f"), min=[0], max=[1]),
                        "output": builder.accessor(np.zeros((2, 3), "f")),
                    }
                ],
            }
        ],
        "extras": {"note": "keep ✓"},
    }
    return builder


def test_every_attribute_and_target_follows_its_vertex():
    builder = rich_grid()
    before = ParsedGlb(builder.build())
    after, uv = unwrap(builder.build())
    assert (after.corners("TEXCOORD_0") == uv).all()
    for name in before.primitive()["attributes"]:
        moved = name.replace("_1", "_2").replace("TEXCOORD_0", "TEXCOORD_1")
        assert (after.corners(moved) == before.corners(name)).all(), name
        old = before.json["accessors"][before.primitive()["attributes"][name]]
        new = after.json["accessors"][after.primitive()["attributes"][moved]]
        ours = {"count", "bufferView"}
        assert {k: v for k, v in old.items() if k not in ours} == {
            k: v for k, v in new.items() if k not in ours
        }
    target = after.array(after.primitive()["targets"][0]["POSITION"])
    order = after.array(after.primitive()["indices"]).ravel()
    wanted = before.array(before.primitive()["targets"][0]["POSITION"])
    assert (target[order] == wanted[before.array(before.primitive()["indices"]).ravel()]).all()


def test_all_else_is_kept_and_no_byte_is_wasted():
    builder = rich_grid()
    before = ParsedGlb(builder.build())
    after, _ = unwrap(builder.build())
    for key in ("asset", "scene", "scenes", "nodes", "textures", "animations", "extras"):
        assert after.json[key] == before.json[key]
    sampler = before.json["animations"][0]["samplers"][0]
    for accessor in sampler.values():
        assert (after.array(accessor) == before.array(accessor)).all()
    assert after.view(after.json["images"][0]["bufferView"]) == b"not really a PNG!"
    covered = sum(view["byteLength"] for view in after.json["bufferViews"])
    assert len(after.binary) - covered < 8 * len(after.json["bufferViews"])
    used = {accessor.get("bufferView") for accessor in after.json["accessors"]}
    used.add(after.json["images"][0]["bufferView"])
    assert used == set(range(len(after.json["bufferViews"])))


def test_without_seams_only_the_uvs_are_added():
    builder = rich_grid()
    before = ParsedGlb(builder.build())
    after, uv = unwrap(builder.build(), one_patch)
    assert after.json["accessors"][:-1] == before.json["accessors"]
    assert after.binary.startswith(before.binary)
    assert (after.corners("TEXCOORD_0") == uv).all()
    assert len(after.array(after.primitive()["attributes"]["POSITION"])) == 7 * 6


def test_a_vertex_is_split_only_where_its_uvs_differ():
    points, faces = grid(6, 5)
    uv = seamless(points, faces)
    uv[:30] /= 2  # the first half of the faces is another chart
    shared = set(faces[:30].ravel()) & set(faces[30:].ravel())
    after, _ = unwrap(rich_grid().build(), lambda count: uv)
    moved = {v for v in shared if (points[v, :2] != 0).any()}  # the origin stays where it is
    assert len(after.array(after.primitive()["attributes"]["POSITION"])) == len(points) + len(moved)


@pytest.mark.parametrize(
    ("existing_uv", "names"),
    [
        ("keep", {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"}),
        ("append", {"TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2"}),
        ("replace", {"TEXCOORD_0", "TEXCOORD_1"}),
    ],
)
def test_existing_sets(existing_uv, names):
    builder = rich_grid()
    before = ParsedGlb(builder.build())
    after, uv = unwrap(builder.build(), existing_uv=existing_uv)
    found = {name for name in after.primitive()["attributes"] if name.startswith("TEXCOORD")}
    assert found == names
    texture = after.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]
    atlas = "TEXCOORD_2" if existing_uv == "append" else "TEXCOORD_0"
    assert (after.corners(atlas) == uv).all()
    assert texture.get("texCoord", 0) == (1 if existing_uv == "keep" else 0)
    if existing_uv != "replace":
        shown = f"TEXCOORD_{texture.get('texCoord', 0)}"
        assert (after.corners(shown) == before.corners("TEXCOORD_0")).all()
    light = "TEXCOORD_2" if existing_uv == "keep" else "TEXCOORD_1"
    assert (after.corners(light) == before.corners("TEXCOORD_1")).all()
    assert len(after.json["accessors"]) == len(before.json["accessors"]) + (
        existing_uv != "replace"
    )


def test_texture_references_of_extensions_and_transforms_move_with_their_set():
    builder = rich_grid()
    material = builder.json["materials"][0]
    material["normalTexture"] = {
        "index": 0,
        "texCoord": 1,
        "extensions": {"KHR_texture_transform": {"texCoord": 0, "scale": [2, 2]}},
    }
    material["extensions"] = {
        "KHR_materials_clearcoat": {"clearcoatTexture": {"index": 0}, "clearcoatFactor": 1}
    }
    material["extras"] = {"fakeTexture": {"index": 3}}
    after, _ = unwrap(builder.build())
    moved = after.json["materials"][0]
    assert moved["normalTexture"]["texCoord"] == 2
    assert moved["normalTexture"]["extensions"]["KHR_texture_transform"]["texCoord"] == 1
    clearcoat = moved["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"]
    assert clearcoat == {"index": 0, "texCoord": 1}
    assert moved["extras"] == material["extras"]


def test_a_material_shared_with_points_is_copied_for_the_triangles():
    builder = rich_grid()
    primitives = builder.json["meshes"][0]["primitives"]
    untouched = {k: v for k, v in primitives[0].items() if k != "targets"} | {"mode": 0}
    primitives.append(copy.deepcopy(untouched))
    after, _ = unwrap(builder.build())
    assert after.primitive(0, 1) == untouched
    assert after.primitive(0, 0)["material"] == 1
    assert after.json["materials"][0] == builder.json["materials"][0]
    assert after.json["materials"][1]["name"] == "skin"


def test_animations_of_a_copied_material_move_the_copy_too():
    builder = rich_grid()
    primitives = builder.json["meshes"][0]["primitives"]
    primitives.append({"attributes": primitives[0]["attributes"], "mode": 0, "material": 0})
    pointer = {"pointer": "/materials/0/emissiveFactor"}
    target = {"path": "pointer", "extensions": {"KHR_animation_pointer": pointer}}
    channels = builder.json["animations"][0]["channels"]
    channels.append({"sampler": 0, "target": target})
    after, _ = unwrap(builder.build())
    moved = after.json["animations"][0]["channels"]
    assert moved[:2] == channels
    assert moved[2]["target"]["extensions"]["KHR_animation_pointer"] == {
        "pointer": "/materials/1/emissiveFactor"
    }


def test_variants_follow():
    builder = rich_grid()
    builder.json["materials"].append({"emissiveTexture": {"index": 0}})
    variants = {"mappings": [{"variants": [0], "material": 1}]}
    builder.json["meshes"][0]["primitives"][0]["extensions"] = {"KHR_materials_variants": variants}
    after, _ = unwrap(builder.build())
    assert after.json["materials"][1]["emissiveTexture"]["texCoord"] == 1


def test_primitives_that_share_vertices_go_on_sharing_them():
    points, faces = grid(6, 5)
    builder = GlbBuilder()
    position = builder.positions(points)
    halves = [builder.accessor(half.ravel().astype("H")) for half in (faces[:30], faces[30:])]
    builder.node(
        mesh=builder.mesh(*({"attributes": {"POSITION": position}, "indices": i} for i in halves))
    )
    after, uv = unwrap(builder.build())
    first, second = after.primitive(0, 0), after.primitive(0, 1)
    assert first["attributes"] == second["attributes"]
    assert (after.corners("TEXCOORD_0", 0, 0) == uv[:30]).all()
    assert (after.corners("TEXCOORD_0", 0, 1) == uv[30:]).all()
    assert (after.corners("POSITION", 0, 1) == points[faces[30:]]).all()


def test_two_meshes_with_the_same_arrays_get_places_of_their_own():
    builder = tetrahedron()
    builder.node(mesh=builder.mesh(copy.deepcopy(builder.json["meshes"][0]["primitives"][0])))
    after, uv = unwrap(builder.build())
    assert (after.corners("TEXCOORD_0", 0) == uv[:4]).all()
    assert (after.corners("TEXCOORD_0", 1) == uv[4:]).all()
    assert (after.corners("POSITION", 1) == TETRAHEDRON[TETRAHEDRON_FACES]).all()


def test_arrays_that_others_count_on_stay_as_they_are():
    builder = rich_grid()
    attributes = builder.json["meshes"][0]["primitives"][0]["attributes"]
    points = {"attributes": {"POSITION": attributes["POSITION"]}, "mode": 0}  # draws all vertices
    builder.json["meshes"][0]["primitives"].append(points)
    before = ParsedGlb(builder.build())
    after, _ = unwrap(builder.build())
    assert after.primitive(0, 1) == points
    kept = attributes["POSITION"]
    assert (after.array(kept) == before.array(kept)).all()
    assert (after.corners("POSITION") == before.corners("POSITION")).all()


@pytest.mark.parametrize(("mode", "count"), [(5, 10), (6, 10)])
@pytest.mark.parametrize("indexed", [True, False])
def test_strips_and_fans_become_triangles(mode, count, indexed):
    angle = np.linspace(0, 3, 12)
    points = np.stack([np.cos(angle), np.sin(angle), angle], axis=1).astype("f")
    builder = GlbBuilder()
    primitive = {"attributes": {"POSITION": builder.positions(points)}, "mode": mode}
    if indexed:
        primitive["indices"] = builder.accessor(np.arange(12, dtype="B"))
    builder.node(mesh=builder.mesh(primitive))
    scene = Scene(builder.build())
    after, uv = unwrap(builder.build())
    assert (after.corners("TEXCOORD_0") == uv).all()
    assert len(uv) == count
    assert (after.corners("POSITION") == scene.soup.positions[scene.soup.faces]).all()


def test_mirrored_meshes_keep_their_stored_winding():
    builder = tetrahedron()
    builder.json["nodes"][0]["scale"] = [1, -1, 1]
    after, uv = unwrap(builder.build())
    assert (after.corners("POSITION") == TETRAHEDRON[TETRAHEDRON_FACES]).all()
    assert (after.corners("TEXCOORD_0") == uv[:, ::-1]).all()


def test_indices_widen_when_the_vertices_outgrow_them():
    points, faces = grid(10, 10)
    builder = GlbBuilder()
    primitive = {
        "attributes": {"POSITION": builder.positions(points)},
        "indices": builder.accessor(faces.ravel().astype("B"), min=[0], max=[120]),
    }
    builder.node(mesh=builder.mesh(primitive))
    after, uv = unwrap(builder.build())
    indices = after.json["accessors"][1]
    assert indices["componentType"] == 5123
    assert indices["max"] == [int(after.array(1).max())]
    assert (after.corners("TEXCOORD_0") == uv).all()


def test_sparse_accessors_stay_sparse():
    builder = rich_grid()
    points, faces = grid(6, 5)
    places = np.array([3, 20], "B")
    moves = np.array([[1, 2, 3], [4, 5, 6]], "f")
    builder.json["accessors"].append(
        {
            "componentType": 5126,
            "count": len(points),
            "type": "VEC3",
            "sparse": {
                "count": 2,
                "indices": {"bufferView": builder.view(places.tobytes()), "componentType": 5121},
                "values": {"bufferView": builder.view(moves.tobytes())},
            },
        }
    )
    target = {"POSITION": len(builder.json["accessors"]) - 1}
    builder.json["meshes"][0]["primitives"][0]["targets"].append(target)
    before = ParsedGlb(builder.build())
    after, _ = unwrap(builder.build())
    accessor = after.primitive()["targets"][1]["POSITION"]
    assert "bufferView" not in after.json["accessors"][accessor]
    order = after.array(after.primitive()["indices"]).ravel()
    wanted = before.array(target["POSITION"])[faces.ravel()]
    assert (after.array(accessor)[order] == wanted).all()


def test_quantized_attributes_are_padded_to_four_bytes():
    builder = tetrahedron()
    colors = np.zeros((4, 4), "B")
    colors[:, :3] = np.arange(12).reshape(4, 3)
    accessor = builder.accessor(colors, normalized=True)
    builder.json["accessors"][accessor]["type"] = "VEC3"
    builder.json["bufferViews"][-1]["byteStride"] = 4
    builder.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor
    after, _ = unwrap(builder.build())
    assert (after.corners("COLOR_0") == colors[:, :3][TETRAHEDRON_FACES]).all()
    view = after.json["accessors"][accessor]["bufferView"]
    assert after.json["bufferViews"][view]["byteStride"] == 4


def test_all_buffers_become_the_binary_chunk():
    after, uv = unwrap(tetrahedron().data_uri())
    assert [set(buffer) for buffer in after.json["buffers"]] == [{"byteLength"}]
    assert (after.corners("TEXCOORD_0") == uv).all()


def test_unknown_extensions_keep_every_buffer_view_they_might_name():
    builder = rich_grid()
    secret = builder.view(b"secret..")
    builder.json["extensionsUsed"] = ["ACME_secret"]
    builder.json["extensions"] = {"ACME_secret": {"blob": secret}}
    before = ParsedGlb(builder.build())
    after, _ = unwrap(builder.build())
    assert after.json["extensions"] == before.json["extensions"]
    assert after.view(secret) == b"secret.."
    assert after.json["bufferViews"][: secret + 1] == before.json["bufferViews"]


def test_unknown_chunks_are_kept():
    data = tetrahedron().build()
    extra = (0x20202020).to_bytes(4, "little")
    data += (4).to_bytes(4, "little") + extra + b"abcd"
    data = data[:8] + len(data).to_bytes(4, "little") + data[12:]
    after, _ = unwrap(data)
    assert after.chunks[2] == (0x20202020, b"abcd")


def test_the_same_input_gives_the_same_bytes_and_is_not_changed():
    data = rich_grid().build()
    scene = Scene(data)
    uv = separate_faces(len(scene.soup.faces))
    first = scene.write(uv, "keep")
    assert scene.write(uv, "keep") == first == Scene(data).write(uv, "keep")


def test_the_flip_of_v_is_exact():
    uv = separate_faces(60)
    after, _ = unwrap(rich_grid().build(), lambda count: uv)
    stored = after.corners("TEXCOORD_0").astype(np.float64)
    assert (1 - stored[..., 1] == uv[..., 1].astype(np.float64)).all()


@pytest.mark.parametrize("existing_uv", ["keep", "append", "replace"])
def test_tangents_change_only_with_the_uv_set_of_their_normal_map(existing_uv):
    builder = rich_grid()
    builder.json["materials"][0]["normalTexture"] = {"index": 0}
    before = ParsedGlb(builder.build())
    uv = one_patch(0)
    turned = np.stack([uv[..., 1], 1 - uv[..., 0]], axis=-1)
    after, _ = unwrap(builder.build(), lambda count: turned, existing_uv)
    if existing_uv == "replace":
        assert np.allclose(after.corners("TANGENT"), [0, 1, 0, 1])
        assert len(after.json["accessors"]) == len(before.json["accessors"])
    else:
        assert (after.corners("TANGENT") == before.corners("TANGENT")).all()


def test_tangents_without_a_normal_map_stay():
    after, _ = unwrap(rich_grid().build(), existing_uv="replace")
    assert (after.corners("TANGENT") == [1, 0, 0, 1]).all()
