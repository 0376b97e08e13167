"""Buffers and buffer views: where the bytes of a document lie (glTF 2.0, section 3.6)."""

from __future__ import annotations

import base64
import binascii
from dataclasses import dataclass
from typing import Any

from partuv_contract.errors import ExternalUriError, LimitError, MalformedGlbError

from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.limits import Limits

_DATA_URI_TYPES = ("data:application/octet-stream;base64", "data:application/gltf-buffer;base64")
LARGEST_STRIDE = 252
ARRAY_BUFFER = 34962
ELEMENT_ARRAY_BUFFER = 34963


@dataclass(frozen=True)
class BufferView:
    """A checked range of a buffer. `stride` is 0 when elements are tightly packed."""

    content: memoryview
    stride: int
    pointer: str


class Buffers:
    """The buffers of a document and checked access to its buffer views."""

    def __init__(self, root: Cursor, binary: memoryview | None, limits: Limits) -> None:
        self._root = root
        self._binary = binary
        self._limits = limits
        self._contents: dict[int, memoryview] = {}
        self._checked: dict[int, BufferView] = {}

    def __len__(self) -> int:
        return self._root.length("buffers")

    def view_count(self) -> int:
        """How many buffer views the document has."""
        return self._root.length("bufferViews")

    def check_all(self) -> None:
        """Check every buffer view, also those that the reader has no use for."""
        for index in range(self.view_count()):
            self.view(index)

    def append(self, content: bytes) -> int:
        """Add a buffer to the document, held in memory; returns its number."""
        index = len(self)
        self._root.value.setdefault("buffers", []).append({"byteLength": len(content)})
        self._contents[index] = memoryview(content)
        return index

    def append_view(self, view: dict[str, Any]) -> int:
        """Add a buffer view to the document; returns its number."""
        self._root.value.setdefault("bufferViews", []).append(view)
        return self.view_count() - 1

    def content(self, index: int) -> memoryview:
        """The bytes of one buffer, exactly `byteLength` of them."""
        if index not in self._contents:
            self._contents[index] = self._load(index)
        return self._contents[index]

    def view(self, index: int) -> BufferView:
        """One buffer view, its range checked against its buffer."""
        if index not in self._checked:
            view = self._root.element("bufferViews", index)
            stride = view.integer("byteStride", 0, 4, LARGEST_STRIDE)
            self._checked[index] = BufferView(self.range_of(view), stride, view.pointer)
        return self._checked[index]

    def range_of(self, owner: Cursor) -> memoryview:
        """The bytes that an object with `buffer`, `byteOffset` and `byteLength` names."""
        content = self.content(owner.need("buffer").as_index(len(self), "buffer"))
        offset = owner.integer("byteOffset", 0)
        length = owner.need("byteLength").as_integer(1)
        if offset + length > len(content):
            owner.fail(f"bytes {offset} to {offset + length} of a buffer of {len(content)} bytes")
        return content[offset : offset + length]

    def _load(self, index: int) -> memoryview:
        buffer = self._root.element("buffers", index)
        length = buffer.need("byteLength").as_integer(1)
        uri = buffer.get("uri")
        if uri is not None:
            content = _decode_data_uri(uri, self._limits)
        elif index == 0 and self._binary is not None:
            content = self._binary
        else:
            buffer.fail("has no uri, and is not the buffer of the BIN chunk")
        if length > len(content):
            buffer.fail(f"declares {length} bytes, {len(content)} are there")
        return content[:length]


def _decode_data_uri(uri: Cursor, limits: Limits) -> memoryview:
    text = uri.as_text()
    kind, comma, encoded = text.partition(",")
    if not comma or not kind.startswith("data:"):
        raise ExternalUriError(
            "a buffer outside the file; pack the asset into one GLB", pointer=uri.pointer
        )
    if kind not in _DATA_URI_TYPES:
        raise MalformedGlbError(f"data URI of the kind {kind[:60]!r}", pointer=uri.pointer)
    if len(encoded) // 4 * 3 > limits.file_bytes:
        raise LimitError("a data URI larger than a file may be", pointer=uri.pointer)
    try:
        return memoryview(base64.b64decode(encoded, validate=True))
    except binascii.Error:
        raise MalformedGlbError("a data URI that is not base64", pointer=uri.pointer) from None
