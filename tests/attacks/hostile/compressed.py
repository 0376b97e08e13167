"""Compressed streams, against their decoders."""

from __future__ import annotations

import DracoPy
import meshopt
import numpy as np
from partuv_contract.errors import LimitError, MalformedGlbError

from tests.attacks.hostile.catalogue import attack
from tests.support.glb_builder import GlbBuilder, grid, tetrahedron

DRACO = "KHR_draco_mesh_compression"
MESHOPT = "EXT_meshopt_compression"


@attack(LimitError)
def meshopt_bomb():
    """Sixteen bytes of meshopt that claim a gigabyte."""
    builder = tetrahedron()
    declared = {"buffer": 0, "byteLength": 16, "byteStride": 16, "count": 2**26}
    builder.json["bufferViews"].append(
        {
            "buffer": 0,
            "byteLength": 2**30,
            "extensions": {MESHOPT: declared | {"mode": "ATTRIBUTES"}},
        }
    )
    builder.json["extensionsRequired"] = builder.json["extensionsUsed"] = [MESHOPT]
    return builder.build()


@attack(MalformedGlbError)
def meshopt_garbage():
    """A meshopt stream with its middle overwritten, for the decoder to run astray."""
    builder = tetrahedron()
    points, _ = grid(20, 20)
    rows = np.zeros((len(points), 4), "f")
    rows[:, :3] = points
    stream = bytearray(meshopt.encode_gltf_buffer(rows, "ATTRIBUTES"))
    stream[1:] = b"\xff" * (len(stream) - 1)
    start = len(builder.binary)
    builder.binary += bytes(stream)
    declared = {"buffer": 0, "byteOffset": start, "byteLength": len(stream), "byteStride": 16}
    builder.json["bufferViews"].append(
        {
            "buffer": 0,
            "byteLength": rows.nbytes,
            "extensions": {MESHOPT: declared | {"count": len(rows), "mode": "ATTRIBUTES"}},
        }
    )
    return builder.build()


def draco_primitive(stream, face_count, vertex_count):
    builder = GlbBuilder()
    view = builder.view(stream)
    builder.json["accessors"] = [
        {"componentType": 5126, "count": vertex_count, "type": "VEC3"},
        {"componentType": 5125, "count": 3 * face_count, "type": "SCALAR"},
    ]
    declared = {"bufferView": view, "attributes": {"POSITION": 0}}
    primitive = {"attributes": {"POSITION": 0}, "indices": 1, "extensions": {DRACO: declared}}
    builder.node(mesh=builder.mesh(primitive))
    builder.json["extensionsRequired"] = builder.json["extensionsUsed"] = [DRACO]
    return builder.build()


@attack(LimitError)
def draco_bomb():
    """A Draco header alone that claims two million triangles, accessors that agree with it."""
    varint = bytes([0x80 | (2**21 & 0x7F), 0x80 | (2**21 >> 7 & 0x7F), 0x80 | 0, 1])
    stream = b"DRACO\x02\x02\x01\x01\0\0\0" + varint + varint + bytes(16)
    return draco_primitive(stream, 2**21, 2**21)


@attack(MalformedGlbError)
def draco_garbage():
    """A true Draco header with noise behind it, for the decoder to run astray."""
    points, faces = grid(8, 8)
    stream = bytearray(DracoPy.encode(points, faces))
    stream[20:] = np.random.default_rng(3).bytes(len(stream) - 20)
    return draco_primitive(bytes(stream), len(faces), len(points))
