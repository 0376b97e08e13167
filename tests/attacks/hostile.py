"""Hostile GLB files, one per line of defence, each with a sentence on what it tries."""

from __future__ import annotations

import base64
import struct
from collections.abc import Callable
from dataclasses import dataclass

import DracoPy
import meshopt
import numpy as np
from partuv_contract.errors import (
    ExternalUriError,
    LimitError,
    MalformedGlbError,
    NonFinitePositionError,
    NotGlbError,
    NoTrianglesError,
    PartuvError,
    UnsupportedError,
)

from tests.support.glb_builder import GlbBuilder, grid, pack, tetrahedron

DRACO = "KHR_draco_mesh_compression"
MESHOPT = "EXT_meshopt_compression"


@dataclass(frozen=True)
class Attack:
    """A file, what it tries, and how it must be refused."""

    tries: str
    error: type[PartuvError]
    build: Callable[[], bytes]


ATTACKS: dict[str, Attack] = {}


def attack(error: type[PartuvError]):
    """Register a builder of bytes; its docstring says what the file tries."""

    def register(build: Callable[[], bytes]) -> Callable[[], bytes]:
        ATTACKS[build.__name__] = Attack(build.__doc__ or "", error, build)
        return build

    return register


# The container


@attack(NotGlbError)
def empty():
    """Has no byte to read the magic from."""
    return b""


@attack(MalformedGlbError)
def length_beyond_the_end():
    """Declares 4 GiB, to make a reader allocate them or read past its buffer."""
    data = bytearray(tetrahedron().build())
    data[8:12] = struct.pack("<I", 0xFFFFFFFF)
    return bytes(data)


@attack(MalformedGlbError)
def trailing_bytes():
    """Hides a second file behind the declared end."""
    return tetrahedron().build() + b"MZ\x90\x00"


@attack(MalformedGlbError)
def chunk_length_wraps():
    """A chunk length of 2^32 - 4, so that start + length wraps around in 32 bits."""
    data = bytearray(tetrahedron().build())
    data[12:16] = struct.pack("<I", 0xFFFFFFFC)
    return bytes(data)


@attack(MalformedGlbError)
def two_json_chunks():
    """Two documents, so that two readers see two different files."""
    return pack({"asset": {"version": "2.0"}}, None, (0x4E4F534A, b'{"asset":{}}'))


# The JSON text


@attack(LimitError)
def million_brackets():
    """A million nested arrays, to exhaust the stack of a recursive parser."""
    return pack(b'{"a":' + b"[" * 1_000_000 + b"]" * 1_000_000 + b"}", None)


@attack(LimitError)
def nesting_behind_an_escaped_quote():
    """Nesting that a scanner overlooks if it takes an escaped quote for the end of a string."""
    return pack(b'{"a":"\\\\","b":' + b"[" * 5000 + b'"\\""' + b"]" * 5000 + b"}", None)


@attack(LimitError)
def ten_million_values():
    """20 MB of text that would become gigabytes of Python objects."""
    return pack(b'{"a":[' + b"0," * 10_000_000 + b"0]}", None)


@attack(MalformedGlbError)
def integer_of_a_million_digits():
    """A number whose conversion takes quadratic time."""
    return pack(b'{"a":' + b"9" * 1_000_000 + b"}", None)


@attack(MalformedGlbError)
def duplicate_keys():
    """Two `meshes`, of which a checker reads the first and a consumer the second."""
    return pack(b'{"asset":{"version":"2.0"},"meshes":[],"meshes":[]}', None)


@attack(MalformedGlbError)
def not_a_number():
    """NaN where JSON has none, to slip past comparisons."""
    return pack(b'{"asset":{"version":"2.0"},"nodes":[{"scale":[NaN,1,1]}]}', None)


@attack(MalformedGlbError)
def invalid_utf8():
    """A byte sequence that decoders replace or drop differently."""
    return pack(b'{"asset":{"version":"2.0","copyright":"\xc0\xaf"}}', None)


# Buffers and accessors


def with_accessor(**changes):
    builder = tetrahedron()
    builder.json["accessors"][0].update(changes)
    return builder.build()


@attack(LimitError)
def zeros_without_bytes():
    """2^30 positions without a buffer view: twelve GiB of zeros for a hundred bytes."""
    builder = tetrahedron()
    builder.json["accessors"][0]["count"] = 2**30
    del builder.json["accessors"][0]["bufferView"]
    return builder.build()


@attack(MalformedGlbError)
def count_that_overflows():
    """A count whose product with the element size is 0 modulo 2^32."""
    return with_accessor(count=2**24 // 12 * 4, byteOffset=0)


@attack(MalformedGlbError)
def negative_offset():
    """Reads the bytes before its view."""
    return with_accessor(byteOffset=-48)


@attack(MalformedGlbError)
def offset_near_2_64():
    """An offset that wraps around in 64 bits."""
    return with_accessor(byteOffset=2**64 - 48)


@attack(MalformedGlbError)
def overlapping_elements():
    """A stride below the element's size, so that elements overlap and alias each other."""
    builder = tetrahedron()
    builder.json["bufferViews"][0]["byteStride"] = 4
    return builder.build()


@attack(MalformedGlbError)
def view_beyond_the_buffer():
    """A view that ends behind its buffer, over whatever lies there in memory."""
    builder = tetrahedron()
    builder.json["bufferViews"][0]["byteLength"] = 10**6
    return builder.build()


@attack(MalformedGlbError)
def buffer_longer_than_the_chunk():
    """A buffer that claims more than the BIN chunk holds."""
    builder = tetrahedron()
    builder.json["buffers"] = [{"byteLength": 10**9}]
    return builder.build()


@attack(MalformedGlbError)
def index_out_of_range():
    """An index far behind the vertices."""
    builder = tetrahedron()
    builder.binary = builder.binary[:48] + struct.pack("<H", 65535) + builder.binary[50:]
    return builder.build()


@attack(MalformedGlbError)
def negative_reference():
    """Mesh -1, which Python takes for the last one."""
    builder = tetrahedron()
    builder.json["nodes"][0]["mesh"] = -1
    return builder.build()


@attack(MalformedGlbError)
def true_for_one():
    """A boolean for an index, which Python takes for the number 1."""
    builder = tetrahedron()
    builder.json["meshes"][0]["primitives"][0]["indices"] = True
    return builder.build()


@attack(MalformedGlbError)
def sparse_indices_that_fall():
    """Sparse indices out of order, the last in range and the first far beyond it."""
    builder = tetrahedron()
    indices = builder.view(np.array([60000, 1], "H").tobytes())
    values = builder.view(np.zeros((2, 3), "f").tobytes())
    builder.json["accessors"][0]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": indices, "componentType": 5123},
        "values": {"bufferView": values},
    }
    return builder.build()


@attack(MalformedGlbError)
def attributes_of_unequal_length():
    """A normal array shorter than the positions, to be read past its end when vertices split."""
    builder = tetrahedron()
    normals = builder.accessor(np.zeros((2, 3), "f"))
    builder.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals
    return builder.build()


@attack(LimitError)
def many_primitives_over_one_array():
    """A small array drawn a million times: a file of megabytes that costs terabytes."""
    points, faces = grid(300, 300)
    builder = GlbBuilder()
    position = builder.positions(points)
    indices = builder.accessor(faces.ravel().astype("I"))
    primitive = {"attributes": {"POSITION": position}, "indices": indices}
    builder.node(mesh=builder.mesh(*[primitive] * 5000))
    return builder.build()


@attack(NonFinitePositionError)
def infinite_position():
    """A position at infinity, to break every bound and mean."""
    builder = tetrahedron()
    builder.binary = struct.pack("<f", float("inf")) + builder.binary[4:]
    return builder.build()


# The node graph


@attack(MalformedGlbError)
def circle_of_nodes():
    """Nodes that are their own ancestors, to make a walk endless."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [2]}, {"children": [1]}]
    return builder.build()


@attack(MalformedGlbError)
def exponential_graph():
    """Forty levels that each name the next one twice: 2^40 instances."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [k + 2, k + 2]} for k in range(40)] + [{"mesh": 0}]
    return builder.build()


@attack(LimitError)
def endless_chain():
    """Twenty thousand nodes in one line, to exhaust a recursive walk."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [k + 2]} for k in range(20_000)] + [{"mesh": 0}]
    builder.json["scenes"][0]["nodes"].append(1)
    return builder.build()


@attack(MalformedGlbError)
def transform_to_infinity():
    """Finite numbers that multiply to infinity on the way down the graph."""
    builder = tetrahedron()
    builder.json["nodes"] += [{"children": [2], "scale": [1e200] * 3}, {"scale": [1e200] * 3}]
    builder.json["nodes"][2]["mesh"] = 0
    builder.json["scenes"][0]["nodes"] = [1]
    return builder.build()


# What lies outside the file


def with_buffer(uri):
    builder = tetrahedron()
    builder.json["buffers"] = [{"byteLength": len(builder.binary), "uri": uri}]
    return builder.build()


@attack(ExternalUriError)
def local_file():
    """Reads a file of the server."""
    return with_buffer("file:///etc/passwd")


@attack(ExternalUriError)
def relative_path():
    """Climbs out of the working folder."""
    return with_buffer("../../../../etc/passwd")


@attack(ExternalUriError)
def metadata_service():
    """Makes the server ask the address where cloud machines keep their credentials."""
    return with_buffer("http://169.254.169.254/latest/meta-data/")


@attack(ExternalUriError)
def capital_data():
    """A URI that a sloppy check takes for a data URI."""
    return with_buffer("DATA.example.com/data:application/octet-stream;base64,AAAA")


@attack(MalformedGlbError)
def short_data_uri():
    """A data URI that holds less than its buffer claims."""
    text = base64.b64encode(b"short").decode()
    return with_buffer(f"data:application/octet-stream;base64,{text}")


# Compressed streams


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


# What the file asks of its readers


@attack(UnsupportedError)
def unknown_requirement():
    """Requires an extension that may change what every number means."""
    builder = tetrahedron()
    builder.json["extensionsRequired"] = ["ACME_encrypted_geometry"]
    return builder.build()


@attack(NoTrianglesError)
def nothing_to_do():
    """A valid scene without a triangle, to reach the engine with an empty mesh."""
    builder = tetrahedron()
    builder.json["meshes"][0]["primitives"][0]["mode"] = 1
    return builder.build()
