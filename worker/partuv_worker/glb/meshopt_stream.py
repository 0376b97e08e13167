"""EXT_meshopt_compression and its ratified twin: the bytes of one compressed buffer view."""

from __future__ import annotations

import meshopt
import numpy as np

from partuv_worker.glb.cursor import Cursor

_MODES = ("ATTRIBUTES", "TRIANGLES", "INDICES")
_FILTER_STRIDES = {
    "NONE": range(4, 257, 4),
    "OCTAHEDRAL": (4, 8),
    "QUATERNION": (8,),
    "EXPONENTIAL": range(4, 257, 4),
    "COLOR": (4, 8),
}


class CompressedView:
    """What the extension object of a buffer view declares, checked."""

    def __init__(self, declared: Cursor, view: Cursor) -> None:
        self._declared = declared
        self.count = declared.need("count").as_integer(1)
        self.stride = declared.need("byteStride").as_integer(1, 256)
        self._mode = declared.need("mode").as_text()
        filter_name = declared.get("filter")
        self._filter = filter_name.as_text() if filter_name is not None else "NONE"
        if self._mode not in _MODES:
            declared.need("mode").fail(f"unknown mode {self._mode[:20]!r}")
        if self._filter not in _FILTER_STRIDES:
            declared.need("filter").fail(f"unknown filter {self._filter[:20]!r}")
        if self._mode == "ATTRIBUTES":
            fits = self.stride in _FILTER_STRIDES[self._filter]
        else:
            fits = self.stride in (2, 4) and self._filter == "NONE"
        if not fits or (self._mode == "TRIANGLES" and self.count % 3):
            declared.fail(
                f"{self.count} elements of {self.stride} bytes cannot be {self._mode} "
                f"with filter {self._filter}"
            )
        if self.size_bytes != view.need("byteLength").as_integer(1):
            view.fail(f"{self.size_bytes} bytes when decoded, but another byteLength")

    @property
    def size_bytes(self) -> int:
        """The size of the decoded view."""
        return self.count * self.stride

    def decode(self, stream: memoryview) -> bytes:
        """The bytes of the view."""
        try:
            decoded = meshopt.decode_gltf_buffer(
                np.frombuffer(stream, np.uint8),
                self.count,
                self.stride,
                self._mode,
                self._filter,
            )
        except Exception as failure:  # the binding does not say which kinds it raises
            self._declared.fail(f"the compressed view does not decode: {str(failure)[:100]}")
        content = np.ascontiguousarray(decoded).tobytes()
        if len(content) != self.size_bytes:
            self._declared.fail("the compressed view decodes to another size than it declares")
        return content
