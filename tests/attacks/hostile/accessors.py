"""Buffers, views, accessors and what they hold."""

from __future__ import annotations

import struct

import numpy as np
from partuv_contract.errors import LimitError, MalformedGlbError, NonFinitePositionError

from tests.attacks.hostile.catalogue import attack
from tests.support.glb_builder import GlbBuilder, grid, tetrahedron


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
