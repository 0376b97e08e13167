"""Lies in the container: lengths and chunks."""

from __future__ import annotations

import struct

from partuv_contract.errors import MalformedGlbError, NotGlbError

from tests.attacks.hostile.catalogue import attack
from tests.support.glb_builder import pack, tetrahedron


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
