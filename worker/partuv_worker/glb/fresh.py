"""A GLB from scratch: arrays first, the document around them last."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import COMPONENT_DTYPES, FLOAT
from partuv_worker.glb.buffers import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER
from partuv_worker.glb.container import join_container
from partuv_worker.glb.jsontext import format_json


class FreshGlb:
    """Collects arrays; each is an accessor with a view of its own."""

    def __init__(self) -> None:
        self._chunks: list[bytes] = []
        self._length = 0
        self._accessors: list[dict[str, Any]] = []
        self._views: list[dict[str, Any]] = []

    def positions(self, array: NDArray[Any]) -> int:
        """V x 3, with the bounds that the specification demands."""
        rounded = array.astype("<f4")
        bounds = {"min": rounded.min(axis=0).tolist(), "max": rounded.max(axis=0).tolist()}
        return self.attribute(rounded, FLOAT, "VEC3", **bounds)

    def attribute(self, array: NDArray[Any], component: int, shape: str, **extra: Any) -> int:
        """One row per vertex, each a multiple of four bytes; returns the accessor's number."""
        return self._add(array, component, shape, ARRAY_BUFFER, extra)

    def indices(self, faces: NDArray[Any], component: int) -> int:
        """F x 3 vertex numbers; returns the accessor's number."""
        return self._add(faces.ravel(), component, "SCALAR", ELEMENT_ARRAY_BUFFER, {})

    def finish(self, document: dict[str, Any]) -> bytes:
        """The GLB; `document` has everything but accessors, views and buffers."""
        stored = {
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": self._length}],
        }
        return join_container(format_json(document | stored), self._chunks, [])

    def _add(
        self, array: NDArray[Any], component: int, shape: str, target: int, extra: dict[str, Any]
    ) -> int:
        content = np.ascontiguousarray(array, COMPONENT_DTYPES[component]).tobytes()
        view = {"buffer": 0, "byteOffset": self._length, "byteLength": len(content)}
        self._views.append(view | {"target": target})
        padded = content + bytes(-len(content) % 4)
        self._chunks.append(padded)
        self._length += len(padded)
        accessor = {"bufferView": len(self._views) - 1, "componentType": component}
        self._accessors.append(accessor | {"count": len(array), "type": shape} | extra)
        return len(self._accessors) - 1
