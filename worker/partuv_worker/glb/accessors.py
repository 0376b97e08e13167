"""Accessors: typed arrays in the buffers, checked before they are touched (glTF 2.0, 3.6.2)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from partuv_contract.errors import LimitError

from partuv_worker.glb.buffers import Buffers, BufferView
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.limits import Limits

Array = NDArray[Any]

BYTE, UNSIGNED_BYTE, SHORT, UNSIGNED_SHORT, UNSIGNED_INT, FLOAT = (
    5120,
    5121,
    5122,
    5123,
    5125,
    5126,
)
COMPONENT_DTYPES: dict[int, np.dtype[Any]] = {
    BYTE: np.dtype("<i1"),
    UNSIGNED_BYTE: np.dtype("<u1"),
    SHORT: np.dtype("<i2"),
    UNSIGNED_SHORT: np.dtype("<u2"),
    UNSIGNED_INT: np.dtype("<u4"),
    FLOAT: np.dtype("<f4"),
}
COLUMNS_AND_ROWS = {
    "SCALAR": (1, 1),
    "VEC2": (1, 2),
    "VEC3": (1, 3),
    "VEC4": (1, 4),
    "MAT2": (2, 2),
    "MAT3": (3, 3),
    "MAT4": (4, 4),
}
_INDEX_TYPES = (UNSIGNED_BYTE, UNSIGNED_SHORT, UNSIGNED_INT)


@dataclass(frozen=True)
class Sparse:
    """Elements that replace those of the base array."""

    indices: NDArray[np.int64]
    rows: NDArray[np.uint8]


@dataclass(frozen=True)
class Accessor:
    """What an accessor declares; its numbers are consistent, its bytes not yet read."""

    index: int
    pointer: str
    kind: str  # SCALAR, VEC2, ...
    component_type: int
    count: int
    normalized: bool
    byte_offset: int
    view: int | None
    sparse: Cursor | None

    @property
    def dtype(self) -> np.dtype[Any]:
        """The type of one component."""
        return COMPONENT_DTYPES[self.component_type]

    @property
    def element_bytes(self) -> int:
        """Bytes of one element."""
        return element_bytes(self.kind, self.dtype)


def element_bytes(kind: str, dtype: np.dtype[Any]) -> int:
    """Bytes of one element of a type such as VEC3; columns of matrices are padded to 4 bytes."""
    columns, rows = COLUMNS_AND_ROWS[kind]
    column_bytes = rows * dtype.itemsize
    return column_bytes if columns == 1 else columns * (-(-column_bytes // 4) * 4)


class Accessors:
    """Checked access to the accessors of a document."""

    def __init__(self, root: Cursor, buffers: Buffers, limits: Limits) -> None:
        self._accessors = root.elements("accessors")
        self._buffers = buffers
        self._limits = limits
        self._bytes_left = limits.decoded_bytes
        self._described: dict[int, Accessor] = {}
        self._counted: set[int] = set()

    def __len__(self) -> int:
        return len(self._accessors)

    def describe(self, index: int) -> Accessor:
        """What accessor `index` declares."""
        if index not in self._described:
            self._described[index] = self._check(index)
        return self._described[index]

    def check_bytes(self, index: int) -> None:
        """Refuse an accessor whose elements do not lie in its buffer views."""
        self.base_rows(index)
        self.sparse(index)

    def base_rows(self, index: int) -> NDArray[np.uint8] | None:
        """The elements as raw bytes (count x element_bytes), without sparse; None means zeros."""
        accessor = self.describe(index)
        self._spend(accessor)
        if accessor.view is None:
            return None
        return _rows_of_view(
            self._buffers.view(accessor.view),
            accessor.byte_offset,
            accessor.count,
            accessor.element_bytes,
            accessor.dtype.itemsize,
            Cursor(None, accessor.pointer),
        )

    def sparse(self, index: int) -> Sparse | None:
        """The sparse part of an accessor, indices strictly increasing and in range."""
        accessor = self.describe(index)
        if accessor.sparse is None:
            return None
        count = accessor.sparse.need("count").as_integer(1, accessor.count)
        indices = self._read_sparse_indices(accessor.sparse.need("indices"), count, accessor.count)
        values = accessor.sparse.need("values")
        rows = _rows_of_view(
            self._view_of(values),
            values.integer("byteOffset", 0),
            count,
            accessor.element_bytes,
            accessor.dtype.itemsize,
            values,
        )
        return Sparse(indices, rows)

    def values(self, index: int) -> Array:
        """The components (count x width) in their own type, sparse elements in place."""
        accessor = self.describe(index)
        columns, width = COLUMNS_AND_ROWS[accessor.kind]
        if columns != 1:
            Cursor(None, accessor.pointer).fail(f"{accessor.kind} where a vector is needed")
        rows = self.base_rows(index)
        sparse = self.sparse(index)
        if rows is None:
            rows = np.zeros((accessor.count, accessor.element_bytes), np.uint8)
        if sparse is not None:
            rows = rows.copy()
            rows[sparse.indices] = sparse.rows
        return _typed(rows, accessor.dtype, width)

    def numbers(self, index: int) -> NDArray[np.float64]:
        """The components as float64, normalised integers mapped to [0, 1] or [-1, 1]."""
        accessor = self.describe(index)
        values = self.values(index)
        numbers = values.astype(np.float64)
        if accessor.normalized and accessor.component_type != FLOAT:
            numbers /= np.iinfo(accessor.dtype).max
            np.maximum(numbers, -1.0, out=numbers)
        return numbers

    def _spend(self, accessor: Accessor) -> None:
        """Count the size of an accessor, once: many may lie over the same few bytes."""
        if accessor.index in self._counted:
            return
        self._counted.add(accessor.index)
        self._bytes_left -= accessor.count * accessor.element_bytes
        if self._bytes_left < 0:
            raise LimitError(
                f"the accessors hold more than {self._limits.decoded_bytes} bytes when decoded",
                pointer=accessor.pointer,
            )

    def _check(self, index: int) -> Accessor:
        accessor = self._accessors[index]
        kind = accessor.need("type").as_text()
        if kind not in COLUMNS_AND_ROWS:
            accessor.need("type").fail(f"unknown type {kind[:20]!r}")
        component = accessor.need("componentType")
        component_type = component.as_integer()
        if component_type not in COMPONENT_DTYPES:
            component.fail(f"unknown component type {component_type}")
        count = accessor.need("count").as_integer(1)
        if count > max(self._limits.vertices, 3 * self._limits.faces):
            raise LimitError(f"{count} elements are too many", pointer=accessor.pointer + "/count")
        return Accessor(
            index=index,
            pointer=accessor.pointer,
            kind=kind,
            component_type=component_type,
            count=count,
            normalized=accessor.flag("normalized"),
            byte_offset=accessor.integer("byteOffset", 0),
            view=accessor.index("bufferView", self._buffers.view_count(), "buffer view"),
            sparse=accessor.get("sparse"),
        )

    def _view_of(self, owner: Cursor) -> BufferView:
        count = self._buffers.view_count()
        view = self._buffers.view(owner.need("bufferView").as_index(count, "buffer view"))
        if view.stride:
            owner.fail("sparse data in a buffer view with a stride")
        return view

    def _read_sparse_indices(self, owner: Cursor, count: int, base_count: int) -> NDArray[np.int64]:
        component_type = owner.need("componentType").as_integer()
        if component_type not in _INDEX_TYPES:
            owner.fail(f"component type {component_type} for indices")
        dtype = COMPONENT_DTYPES[component_type]
        offset = owner.integer("byteOffset", 0)
        view = self._view_of(owner)
        rows = _rows_of_view(view, offset, count, dtype.itemsize, dtype.itemsize, owner)
        indices = _typed(rows, dtype, 1).ravel().astype(np.int64)
        if indices[-1] >= base_count or (np.diff(indices) <= 0).any():
            owner.fail("sparse indices that do not rise, or lie outside the accessor")
        return indices


def _rows_of_view(
    view: BufferView, offset: int, count: int, element_bytes: int, alignment: int, owner: Cursor
) -> NDArray[np.uint8]:
    """The elements of a view as a (count, element_bytes) array of bytes, not copied."""
    stride = view.stride or element_bytes
    if stride < element_bytes:
        owner.fail(f"elements of {element_bytes} bytes overlap at a stride of {stride}")
    if offset % alignment or stride % alignment:
        owner.fail(f"not aligned to its components of {alignment} bytes")
    end = offset + stride * (count - 1) + element_bytes
    if end > len(view.content):
        owner.fail(f"needs {end} bytes of the {len(view.content)} of {view.pointer}")
    return np.ndarray((count, element_bytes), np.uint8, view.content, offset, (stride, 1))


def _typed(rows: NDArray[np.uint8], dtype: np.dtype[Any], width: int) -> Array:
    """Bytes of elements seen as components; copied only if they are not packed."""
    packed = np.ascontiguousarray(rows)
    return packed.reshape(-1).view(dtype).reshape(len(rows), width)
