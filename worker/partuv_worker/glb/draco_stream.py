"""KHR_draco_mesh_compression: triangles and attributes out of a Draco stream.

The decoder trusts the counts in the stream's header and allocates by them, so they are compared
with those of the accessors first. Header: Draco bitstream specification 2.2, sections 3 and 4.
"""

from __future__ import annotations

from typing import Any

import DracoPy
import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.cursor import Cursor

_MAGIC = b"DRACO"
_TRIANGLES = 1  # encoder type; 0 is a point cloud
_SEQUENTIAL, _EDGEBREAKER = 0, 1
_HAS_METADATA = 0x8000


class DracoMesh:
    """A decoded stream."""

    def __init__(self, stream: memoryview, face_count: int, owner: Cursor) -> None:
        """face_count: what the accessor of the indices declares; another count is refused."""
        declared = _declared_faces(bytes(stream), owner)
        if declared != face_count:
            owner.fail(f"the Draco stream has {declared} triangles, its indices {face_count}")
        try:
            mesh = DracoPy.decode(bytes(stream))
            self.corners: NDArray[np.uint32] = np.asarray(mesh.faces, np.uint32).ravel()
            found: list[dict[str, Any]] = mesh.attributes
            self._attributes = {int(entry["unique_id"]): entry["data"] for entry in found}
        except Exception as failure:  # DracoPy raises its own kinds, and ValueError
            owner.fail(f"the Draco stream does not decode: {str(failure)[:100]}")
        if len(self.corners) != 3 * face_count:
            owner.fail("the Draco stream holds another number of triangles than it declares")

    def attribute(self, unique_id: int, owner: Cursor) -> NDArray[Any]:
        """The values (points x width) of the attribute with this id."""
        if unique_id not in self._attributes:
            owner.fail(f"the Draco stream has no attribute {unique_id}")
        values: NDArray[Any] = self._attributes[unique_id]
        return values.reshape(len(values), -1)


class _Header:
    """A reader of the first bytes of a stream."""

    def __init__(self, stream: bytes, owner: Cursor) -> None:
        self._stream = stream
        self._owner = owner
        self._position = 0

    def take(self, count: int) -> bytes:
        taken = self._stream[self._position : self._position + count]
        if len(taken) != count:
            self._owner.fail("the Draco stream ends within its header")
        self._position += count
        return taken

    def byte(self) -> int:
        return self.take(1)[0]

    def varint(self) -> int:
        """LEB128, as the specification names it."""
        value = 0
        for shift in range(0, 63, 7):
            byte = self.byte()
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                return value
        self._owner.fail("the Draco stream has a number without end")

    def skip_metadata(self) -> None:
        """Names and values that an encoder may put before the mesh."""
        for _ in range(self.varint()):
            self.varint()  # the attribute it belongs to
            self._skip_entries()
        self._skip_entries()

    def _skip_entries(self) -> None:
        for _ in range(self.varint()):
            self.take(self.byte())
            self.take(self.varint())
        if self.varint():
            self._owner.fail("nested Draco metadata")


def _declared_faces(stream: bytes, owner: Cursor) -> int:
    """The number of triangles by the header of a stream; refuses all but triangle meshes."""
    header = _Header(stream, owner)
    if header.take(5) != _MAGIC:
        owner.fail("no Draco stream")
    version = (header.byte(), header.byte())
    if version != (2, 2):
        owner.fail(f"Draco bitstream {version[0]}.{version[1]}, only 2.2 is read")
    kind, method = header.byte(), header.byte()
    flags = int.from_bytes(header.take(2), "little")
    if kind != _TRIANGLES or method not in (_SEQUENTIAL, _EDGEBREAKER):
        owner.fail("the Draco stream holds no triangles")
    if flags & _HAS_METADATA:
        header.skip_metadata()
    if method == _SEQUENTIAL:
        faces, vertices = header.varint(), header.varint()
    else:
        header.byte()  # traversal
        vertices, faces = header.varint(), header.varint()
    if vertices > 3 * faces:
        owner.fail(f"the Draco stream declares {vertices} vertices for {faces} triangles")
    return faces
