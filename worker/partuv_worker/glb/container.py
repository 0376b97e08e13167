"""The GLB container: a header and chunks (glTF 2.0 specification, section 4.4)."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from partuv_contract.errors import LimitError, MalformedGlbError, NotGlbError

from partuv_worker.glb.limits import Limits

MAGIC = 0x46546C67
JSON_CHUNK = 0x4E4F534A
BIN_CHUNK = 0x004E4942
_HEADER_BYTES = 12
_CHUNK_HEADER_BYTES = 8


class Chunk(NamedTuple):
    """One chunk, its content not copied."""

    kind: int
    offset: int  # of the content, from the start of the file
    content: memoryview


@dataclass(frozen=True)
class Container:
    """The chunks of a GLB."""

    json: Chunk
    binary: memoryview | None
    others: list[Chunk]  # chunks of unknown kinds, which readers ignore


def split_container(data: bytes, limits: Limits) -> Container:
    """Find the chunks of a GLB 2.0 file; every length is checked against the file's."""
    if len(data) > limits.file_bytes:
        raise LimitError(f"the file has {len(data)} bytes, at most {limits.file_bytes} are allowed")
    if len(data) < _HEADER_BYTES or struct.unpack_from("<I", data)[0] != MAGIC:
        raise NotGlbError("not a GLB file: it does not start with a glTF header", byte_offset=0)
    version, declared_bytes = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise NotGlbError(f"GLB container version {version}, only 2 is read", byte_offset=4)
    if declared_bytes != len(data):
        raise MalformedGlbError(
            f"the header declares {declared_bytes} bytes, the file has {len(data)}", byte_offset=8
        )
    chunks = _chunks(data)
    if not chunks or chunks[0].kind != JSON_CHUNK:
        raise MalformedGlbError("the first chunk is not JSON", byte_offset=_HEADER_BYTES)
    json_chunk, rest = chunks[0], chunks[1:]
    binary = rest.pop(0).content if rest and rest[0].kind == BIN_CHUNK else None
    for chunk in rest:
        if chunk.kind in (JSON_CHUNK, BIN_CHUNK):
            raise MalformedGlbError(
                "a second JSON chunk, or a BIN chunk in the wrong place",
                byte_offset=chunk.offset - _CHUNK_HEADER_BYTES,
            )
    if len(json_chunk.content) > limits.json_bytes:
        raise LimitError(
            f"the JSON chunk has {len(json_chunk.content)} bytes, "
            f"at most {limits.json_bytes} are allowed",
            byte_offset=_HEADER_BYTES,
        )
    return Container(json_chunk, binary, rest)


def join_container(
    json_text: bytes, binary: Sequence[bytes | memoryview], others: Sequence[Chunk]
) -> bytes:
    """Build a GLB from its JSON, the pieces of its BIN chunk (may be empty) and other chunks."""
    pieces: list[bytes | memoryview] = []
    _append_chunk(pieces, JSON_CHUNK, [json_text], b" ")
    if binary:
        _append_chunk(pieces, BIN_CHUNK, binary, b"\0")
    for chunk in others:
        _append_chunk(pieces, chunk.kind, [chunk.content], b"\0")
    total = _HEADER_BYTES + sum(len(piece) for piece in pieces)
    if total >= 1 << 32:
        raise LimitError(f"the result would have {total} bytes, a GLB holds less than 4 GiB")
    return b"".join([struct.pack("<III", MAGIC, 2, total), *pieces])


def _chunks(data: bytes) -> list[Chunk]:
    whole = memoryview(data)
    found = []
    position = _HEADER_BYTES
    while position < len(data):
        start = position + _CHUNK_HEADER_BYTES
        if start > len(data):
            raise MalformedGlbError("a chunk header is cut off", byte_offset=position)
        length, kind = struct.unpack_from("<II", data, position)
        if length > len(data) - start:
            raise MalformedGlbError(
                f"a chunk declares {length} bytes, {len(data) - start} are left",
                byte_offset=position,
            )
        if length % 4:
            raise MalformedGlbError("a chunk's length is no multiple of 4", byte_offset=position)
        found.append(Chunk(kind, start, whole[start : start + length]))
        position = start + length
    return found


def _append_chunk(
    pieces: list[bytes | memoryview],
    kind: int,
    contents: Sequence[bytes | memoryview],
    padding: bytes,
) -> None:
    length = sum(len(content) for content in contents)
    missing = -length % 4
    pieces.append(struct.pack("<II", length + missing, kind))
    pieces.extend(contents)
    pieces.append(padding * missing)
