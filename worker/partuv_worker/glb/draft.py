"""A document being edited: its JSON patched in place, its bytes appended to and compacted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from typing import Any, Literal

from partuv_worker.glb.buffers import Buffers
from partuv_worker.glb.compress import Stream, compress_views
from partuv_worker.glb.compress_draco import draco_streams
from partuv_worker.glb.container import Chunk, join_container
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.extensions import DRACO, MESHOPT
from partuv_worker.glb.jsontext import format_json
from partuv_worker.glb.references import accessor_references, view_owners, views_of

_ALIGNMENT_BYTES = 8  # at least that of every component type

Json = dict[str, Any]
Compression = Literal["none", "meshopt", "draco"]


class Draft:
    """The edited document. Accessors keep their numbers; buffer views may be renumbered."""

    def __init__(self, root: Json, buffers: Buffers, left: set[int], removable: bool) -> None:
        """left: views that something stopped to refer to already. removable: whether views that
        nobody we know refers to may be dropped."""
        self.root: Json = _copied(root)
        self._buffers = buffers
        self._removable = removable
        self._added: dict[int, bytes] = {}
        self._left = set(left)

    @property
    def _cursor(self) -> Cursor:
        return Cursor(self.root, "")

    @property
    def accessors(self) -> list[Json]:
        """The accessors' JSON."""
        found: list[Json] = self.root.setdefault("accessors", [])
        return found

    def primitive(self, mesh: int, number: int) -> Json:
        """The JSON of a primitive."""
        found: Json = self.root["meshes"][mesh]["primitives"][number]
        return found

    def add_view(self, content: bytes, *, target: int | None = None, stride: int = 0) -> int:
        """Append a buffer view with these bytes; returns its number."""
        view: Json = {"buffer": 0, "byteLength": len(content)}
        if stride:
            view["byteStride"] = stride
        if target is not None:
            view["target"] = target
        views = self.root.setdefault("bufferViews", [])
        views.append(view)
        self._added[len(views) - 1] = content
        return len(views) - 1

    def add_accessor(self, accessor: Json) -> int:
        """Append an accessor; returns its number."""
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def leave_views(self, accessor: int) -> None:
        """Note that an accessor is about to be replaced: its views go if nothing else uses them."""
        owners = views_of(Cursor(self.accessors[accessor], f"/accessors/{accessor}"))
        self._left.update(owner.value["bufferView"] for owner in owners)

    def add_extras(self, extras: Mapping[str, Any]) -> None:
        """Add to the extras of the asset; what is there and no object gives way."""
        asset: Json = self.root["asset"]
        known = asset.get("extras")
        asset["extras"] = {**(known if isinstance(known, dict) else {}), **extras}

    def accessor_uses(self) -> Counter[int]:
        """How often the document refers to each accessor."""
        return Counter(reference.value for reference in accessor_references(self._cursor))

    def finish(self, others: list[Chunk], *, compress: Compression = "none") -> bytes:
        """The GLB of the edited document; compress: what vertices and indices become streams of."""
        encoded = self._take_draco_streams() if compress == "draco" else []
        self._drop_views()
        for primitive, stream, ids in encoded:
            declared = {"bufferView": self.add_view(stream), "attributes": ids}
            primitive.setdefault("extensions", {})[DRACO] = declared
        if encoded:
            self._require(DRACO)
        streams = compress_views(self.root, self._content) if compress == "meshopt" else {}
        pieces, length = self._lay_out(streams)
        if length:
            buffers: list[Json] = self.root.get("buffers") or [{}]
            first = {key: value for key, value in buffers[0].items() if key != "uri"}
            self.root["buffers"] = [first | {"byteLength": length}]
        if streams:
            self._declare_streams(streams)
        return join_container(format_json(self.root), pieces, others)

    def _drop_views(self) -> None:
        """Remove the views that were left by their last user, and renumber the rest."""
        if not self._removable or not self._left:
            return
        views: list[Json] = self.root["bufferViews"]
        owners = [owner.value for owner in view_owners(self._cursor)]
        used = {owner["bufferView"] for owner in owners}
        dropped = self._left - used
        kept = [index for index in range(len(views)) if index not in dropped]
        number = {old: new for new, old in enumerate(kept)}
        for owner in owners:
            owner["bufferView"] = number[owner["bufferView"]]
        self.root["bufferViews"] = [views[index] for index in kept]
        added = self._added.items()
        self._added = {number[index]: content for index, content in added if index in number}

    def _content(self, index: int) -> bytes | memoryview:
        """The bytes of a view before it is placed."""
        if index in self._added:
            return self._added[index]
        view = self.root["bufferViews"][index]
        start = view.get("byteOffset", 0)
        return self._buffers.content(view["buffer"])[start : start + view["byteLength"]]

    def _declare_streams(self, streams: dict[int, Stream]) -> None:
        """Let the compressed views lie in a buffer that exists only once they are decoded."""
        length = 0
        for index, stream in streams.items():
            view = self.root["bufferViews"][index]
            view.setdefault("extensions", {})[MESHOPT] = {
                "buffer": 0,
                "byteOffset": view["byteOffset"],
                "byteLength": len(stream.content),
                "byteStride": stream.stride,
                "count": stream.count,
                "mode": stream.mode,
            }
            gap = -length % _ALIGNMENT_BYTES
            view |= {"buffer": 1, "byteOffset": length + gap}
            length += gap + view["byteLength"]
        fallback = {"byteLength": length, "extensions": {MESHOPT: {"fallback": True}}}
        self.root["buffers"].append(fallback)
        self._require(MESHOPT)

    def _require(self, extension: str) -> None:
        for key in ("extensionsUsed", "extensionsRequired"):
            self.root[key] = [*self.root.get(key, []), extension]

    def _take_draco_streams(self) -> list[tuple[Json, bytes, dict[str, int]]]:
        """Streams of primitives, whose accessors then have no view any more."""
        encoded = draco_streams(self.root, self._content)
        for primitive, _, ids in encoded:
            for accessor in (primitive["indices"], *(primitive["attributes"][key] for key in ids)):
                self.leave_views(accessor)
                for key in ("bufferView", "byteOffset"):
                    self.accessors[accessor].pop(key, None)
        return encoded

    def _lay_out(self, streams: dict[int, Stream]) -> tuple[list[bytes | memoryview], int]:
        """Place all views in one buffer; sets their offsets, returns its pieces and length."""
        pieces: list[bytes | memoryview] = []
        length = 0
        views: list[Json] = self.root.get("bufferViews", [])
        appended = self._added | {index: stream.content for index, stream in streams.items()}
        for buffer in range(len(self._buffers)):
            old = [
                view
                for index, view in enumerate(views)
                if index not in appended and view["buffer"] == buffer
            ]
            keep_all = bool(old) and not self._removable
            whole = len(self._buffers.content(buffer)) if keep_all else 0
            for start, end, members in _intervals(old, whole):
                gap = (start - length) % _ALIGNMENT_BYTES
                pieces += [bytes(gap), self._buffers.content(buffer)[start:end]]
                for view in members:
                    view["buffer"] = 0
                    view["byteOffset"] = view.get("byteOffset", 0) - start + length + gap
                length += gap + end - start
        for index, content in sorted(appended.items()):
            gap = -length % _ALIGNMENT_BYTES
            pieces += [bytes(gap), content]
            views[index]["byteOffset"] = length + gap
            length += gap + len(content)
        return pieces, length


def _intervals(views: list[Json], at_least: int) -> Iterator[tuple[int, int, list[Json]]]:
    """The ranges (start, end) that views cover, overlapping ones joined, with their views.

    at_least: the first range covers this many bytes from the start of the buffer.
    """
    if at_least:
        yield 0, at_least, views
        return
    start = end = 0
    members: list[Json] = []
    for view in sorted(views, key=lambda view: int(view.get("byteOffset", 0))):
        first = int(view.get("byteOffset", 0))
        if members and first >= end:
            yield start, end, members
            members = []
        if not members:
            start = end = first
        end = max(end, first + int(view["byteLength"]))
        members.append(view)
    if members:
        yield start, end, members


def _copied(value: Any) -> Any:
    """A copy of a JSON value; `copy.deepcopy` takes three times as long."""
    if isinstance(value, dict):
        return {key: _copied(member) for key, member in value.items()}
    return [_copied(element) for element in value] if isinstance(value, list) else value
