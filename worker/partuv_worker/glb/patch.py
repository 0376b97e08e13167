"""Writing an atlas into a document: vertices split at seams, a new UV set, nothing else changed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import (
    COMPONENT_DTYPES,
    FLOAT,
    UNSIGNED_BYTE,
    UNSIGNED_INT,
    UNSIGNED_SHORT,
    Accessors,
)
from partuv_worker.glb.buffers import ARRAY_BUFFER, ELEMENT_ARRAY_BUFFER
from partuv_worker.glb.draft import Draft, Json
from partuv_worker.glb.primitives import TRIANGLES, Primitive
from partuv_worker.glb.soup import Piece, TriangleSoup
from partuv_worker.glb.split import Split, split_vertices
from partuv_worker.glb.tangents import compute_tangents
from partuv_worker.glb.texcoords import first_free_set, reads_normals_by, shift_sets

ExistingUv = Literal["keep", "append", "replace"]
_REPLACED = "TEXCOORD_0"


def write_atlas(
    draft: Draft,
    accessors: Accessors,
    soup: TriangleSoup,
    corner_uv: NDArray[np.float32],
    existing_uv: ExistingUv,
) -> None:
    """Give every primitive of the soup the UVs of its corners (F x 3 x 2, V up).

    existing_uv: keep makes the atlas TEXCOORD_0 and moves the old sets up by one, append takes the
    first free set, replace takes the place of TEXCOORD_0.
    """
    if existing_uv == "keep":
        shift_sets(draft.root, ((p.primitive.mesh, p.primitive.number) for p in soup.pieces))
    patch = _Patch(draft, accessors, existing_uv)
    for group in _groups_of_shared_vertices(soup.pieces):
        patch.write(group, corner_uv)


def _groups_of_shared_vertices(pieces: Sequence[Piece]) -> list[list[Piece]]:
    """Pieces that share a vertex array are split together, so that they go on sharing it."""
    leader = list(range(len(pieces)))

    def find(index: int) -> int:
        while leader[index] != index:
            leader[index] = leader[leader[index]]
            index = leader[index]
        return index

    owner: dict[int, int] = {}
    for index, piece in enumerate(pieces):
        for accessor in piece.primitive.vertex_accessors():
            first, second = sorted((find(owner.setdefault(accessor, index)), find(index)))
            leader[second] = first
    groups: dict[int, list[Piece]] = {}
    for index, piece in enumerate(pieces):
        groups.setdefault(find(index), []).append(piece)
    return list(groups.values())


class _Patch:
    """The accessors that were replaced so far, and who still uses the old ones."""

    def __init__(self, draft: Draft, accessors: Accessors, existing_uv: ExistingUv) -> None:
        self._draft = draft
        self._accessors = accessors
        self._existing_uv = existing_uv
        self._uses = draft.accessor_uses()
        self._bent: dict[str, bool] = {}

    def write(self, group: Sequence[Piece], corner_uv: NDArray[np.float32]) -> None:
        """Split the vertices of one group and rewrite its primitives."""
        corners = np.concatenate([piece.triangles.ravel() for piece in group])
        uv = np.concatenate([piece.corner_uv(corner_uv).reshape(-1, 2) for piece in group])
        uv[:, 1] = 1 - uv[:, 1]  # V points down in glTF
        vertex_count = self._accessors.describe(group[0].primitive.position).count
        split = split_vertices(corners, uv, vertex_count)
        primitives = [piece.primitive for piece in group]
        moved = self._extend_attributes(primitives, split)
        atlas = self._place(_REPLACED, primitives, split.vertex_uv)
        ends = np.cumsum([piece.triangles.size for piece in group]).tolist()
        ranges = [slice(start, end) for start, end in zip([0, *ends], ends, strict=False)]
        tangents = self._new_tangents(group, split, ranges)
        for piece, own in zip(group, ranges, strict=True):
            self._rewrite(piece, split, own, moved)
            json = self._draft.primitive(piece.primitive.mesh, piece.primitive.number)
            attributes = json["attributes"]
            name = first_free_set(attributes) if self._existing_uv == "append" else _REPLACED
            attributes[name] = atlas[piece.primitive.pointer]
            if piece.primitive.pointer in tangents:
                attributes["TANGENT"] = tangents[piece.primitive.pointer]

    def _extend_attributes(self, primitives: Sequence[Primitive], split: Split) -> dict[int, int]:
        """Append copies to every vertex array; returns old -> new accessor where it changed."""
        own = Counter(
            accessor
            for primitive in primitives
            for attributes in (primitive.attributes, *primitive.targets)
            for name, accessor in attributes.items()
            if name not in self._dropped(primitive)
        )
        moved: dict[int, int] = {}
        if not len(split.sources):
            return moved
        for accessor, uses in sorted(own.items()):
            target = accessor
            if self._uses[accessor] > uses:  # someone else counts on the array as it is
                target = self._draft.add_accessor(dict(self._draft.accessors[accessor]))
            else:
                self._draft.leave_views(accessor)
            self._extend(accessor, target, split.sources)
            moved[accessor] = target
        return moved

    def _extend(self, source: int, target: int, copied: NDArray[np.int64]) -> None:
        old = self._accessors.describe(source)
        json = self._draft.accessors[target]
        json["count"] = old.count + len(copied)
        rows = self._accessors.base_rows(source)
        if rows is not None:
            json["bufferView"] = self._vertex_view(np.concatenate([rows, rows[copied]]))
            json.pop("byteOffset", None)
        sparse = self._accessors.sparse(source)
        if sparse is None or old.sparse is None:
            return
        place = np.searchsorted(sparse.indices, copied)
        place[place == len(sparse.indices)] = 0
        hits = sparse.indices[place] == copied
        indices = np.concatenate([sparse.indices, old.count + np.flatnonzero(hits)])
        values = np.concatenate([sparse.rows, sparse.rows[place[hits]]])
        given = old.sparse.value
        component_type = _index_type(int(indices[-1]), given["indices"]["componentType"])
        packed = indices.astype(COMPONENT_DTYPES[component_type]).tobytes()
        json["sparse"] = given | {
            "count": len(indices),
            "indices": _without_offset(given["indices"])
            | {"bufferView": self._draft.add_view(packed), "componentType": component_type},
            "values": _without_offset(given["values"])
            | {"bufferView": self._draft.add_view(values.tobytes())},
        }

    def _vertex_view(self, rows: NDArray[np.uint8]) -> int:
        """A view of vertex attributes, padded so that each element starts at 4 bytes."""
        count, element_bytes = rows.shape
        stride = -(-element_bytes // 4) * 4
        if stride == element_bytes:
            return self._draft.add_view(rows.tobytes(), target=ARRAY_BUFFER)
        padded = np.zeros((count, stride), np.uint8)
        padded[:, :element_bytes] = rows
        return self._draft.add_view(padded.tobytes(), target=ARRAY_BUFFER, stride=stride)

    def _dropped(self, primitive: Primitive) -> set[str]:
        """The attributes whose old values end with the atlas."""
        if self._existing_uv != "replace":
            return set()
        if primitive.pointer not in self._bent:
            self._bent[primitive.pointer] = self._bends_light(primitive)
        return {_REPLACED, "TANGENT"} if self._bent[primitive.pointer] else {_REPLACED}

    def _bends_light(self, primitive: Primitive) -> bool:
        """Whether tangents are given for a normal map that will be read by the atlas."""
        attributes = primitive.attributes
        if not {"TANGENT", "NORMAL"} <= attributes.keys():
            return False
        if self._accessors.describe(attributes["NORMAL"]).kind != "VEC3":
            return False
        return reads_normals_by(self._draft.root, primitive.mesh, primitive.number, uv_set=0)

    def _new_tangents(
        self, group: Sequence[Piece], split: Split, ranges: Sequence[slice]
    ) -> dict[str, int]:
        """Tangents that go with the atlas, where it replaces the UV set of a normal map."""
        shapes: dict[tuple[int, int], list[int]] = {}
        for number, piece in enumerate(group):
            if "TANGENT" in self._dropped(piece.primitive):
                attributes = piece.primitive.attributes
                shape = attributes["POSITION"], attributes["NORMAL"]
                shapes.setdefault(shape, []).append(number)
        old_count = len(split.vertex_uv) - len(split.sources)
        origin = np.concatenate([np.arange(old_count), split.sources])
        uv = split.vertex_uv.astype(np.float64) * (1, -1) + (0, 1)
        places: dict[str, int] = {}
        for shape, numbers in shapes.items():
            positions, normals = (self._accessors.numbers(index)[origin] for index in shape)
            corners = np.concatenate([split.corners[ranges[number]] for number in numbers])
            tangents = compute_tangents(positions, normals, uv, corners.reshape(-1, 3))
            places |= self._place("TANGENT", [group[n].primitive for n in numbers], tangents)
        return places

    def _place(
        self, name: str, primitives: Sequence[Primitive], values: NDArray[np.float32]
    ) -> dict[str, int]:
        """Store an attribute that a group shares; returns its accessor by primitive (pointer).

        It takes the accessors of the values that it replaces, where nobody else uses those.
        """
        view = self._draft.add_view(values.astype("<f4").tobytes(), target=ARRAY_BUFFER)
        kind = f"VEC{values.shape[1]}"
        json = {"bufferView": view, "componentType": FLOAT, "count": len(values), "type": kind}
        old = Counter(
            p.attributes[name] for p in primitives if name in self._dropped(p) & {*p.attributes}
        )
        taken = {accessor for accessor, uses in old.items() if self._uses[accessor] == uses}
        for accessor in taken:
            self._draft.leave_views(accessor)
            self._draft.accessors[accessor] = dict(json)
        kept = {
            p.pointer: p.attributes[name] for p in primitives if p.attributes.get(name) in taken
        }
        others = [p.pointer for p in primitives if p.pointer not in kept]
        added = dict.fromkeys(others, self._draft.add_accessor(json)) if others else {}
        return kept | added

    def _rewrite(
        self,
        piece: Piece,
        split: Split,
        range_of_piece: slice,
        moved: dict[int, int],
    ) -> None:
        """Let a primitive use the split vertices."""
        corners = split.corners[range_of_piece]
        primitive = piece.primitive
        json = self._draft.primitive(primitive.mesh, primitive.number)
        targets = json.get("targets", [])
        if self._existing_uv == "replace":
            for target in targets:
                target.pop(_REPLACED, None)
        for attributes in (json["attributes"], *targets):
            for name, accessor in attributes.items():
                attributes[name] = moved.get(accessor, accessor)
        is_list = primitive.mode == TRIANGLES and (
            primitive.indices is not None or not len(split.sources)
        )
        if is_list and np.array_equal(corners, piece.triangles.ravel()):
            return
        json["mode"] = TRIANGLES
        json["indices"] = self._indices(primitive.indices, corners)

    def _indices(self, old: int | None, corners: NDArray[np.int64]) -> int:
        """Store the vertex of each corner, in place of the old indices if nobody else uses them."""
        largest = int(corners.max())
        json: Json = {} if old is None else dict(self._draft.accessors[old])
        component_type = _index_type(largest, json.get("componentType", UNSIGNED_SHORT))
        packed = corners.astype(COMPONENT_DTYPES[component_type]).tobytes()
        for key in ("byteOffset", "sparse"):
            json.pop(key, None)
        if "min" in json or "max" in json:
            json |= {"min": [int(corners.min())], "max": [largest]}
        json |= {
            "bufferView": self._draft.add_view(packed, target=ELEMENT_ARRAY_BUFFER),
            "componentType": component_type,
            "count": len(corners),
            "type": "SCALAR",
        }
        if old is None:
            return self._draft.add_accessor(json)
        self._uses[old] -= 1
        if self._uses[old]:
            return self._draft.add_accessor(json)
        self._draft.leave_views(old)
        self._draft.accessors[old] = json
        return old


def _index_type(largest: int, at_least: int) -> int:
    """The smallest type for indices up to `largest`; the highest number of each is reserved."""
    for component_type, reserved in ((UNSIGNED_BYTE, 0xFF), (UNSIGNED_SHORT, 0xFFFF)):
        if largest < reserved and component_type >= at_least:
            return component_type
    return UNSIGNED_INT


def _without_offset(json: Json) -> Json:
    return {key: value for key, value in json.items() if key != "byteOffset"}
