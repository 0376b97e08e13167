"""A GLB as the pipeline sees it: triangles out, UVs in."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from partuv_worker.glb.accessors import Accessors
from partuv_worker.glb.buffers import Buffers
from partuv_worker.glb.container import split_container
from partuv_worker.glb.cursor import Cursor
from partuv_worker.glb.decompress import decompress
from partuv_worker.glb.draft import Compression, Draft
from partuv_worker.glb.existing import read_corner_uv
from partuv_worker.glb.extensions import check_required, only_understood
from partuv_worker.glb.graph import read_graph
from partuv_worker.glb.jsontext import parse_json
from partuv_worker.glb.limits import DEFAULT_LIMITS, Limits
from partuv_worker.glb.patch import ExistingUv, write_atlas
from partuv_worker.glb.primitives import list_primitives
from partuv_worker.glb.references import check_references
from partuv_worker.glb.selection import face_weights, select
from partuv_worker.glb.soup import TriangleSoup, gather_soup


class Scene:
    """The triangles of a GLB, and the means to write an atlas into it.

    A mesh that several nodes use is in the soup once, where it stands first.
    """

    soup: TriangleSoup

    def __init__(
        self, data: bytes, limits: Limits = DEFAULT_LIMITS, only: Sequence[str] = ()
    ) -> None:
        """Read and check; raises an `InputError` that says what is wrong and where.

        only: names of meshes or materials; the soup then holds nothing else.
        """
        container = split_container(data, limits)
        root = Cursor(parse_json(container.json, limits), "")
        _check_version(root)
        check_required(root)
        self._removable = only_understood(root)
        self._root = root
        self._others = container.others
        self._buffers = Buffers(root, container.binary, limits)
        self._left = decompress(root, self._buffers, limits)
        check_references(root)
        self._buffers.check_all()
        self._accessors = Accessors(root, self._buffers, limits)
        graph = read_graph(root, self._accessors, limits)
        primitives = list_primitives(root, self._accessors, limits)
        drawn = [primitive for mesh in graph.places for primitive in primitives[mesh]]
        chosen = select(root, drawn, only)
        self.soup = gather_soup(chosen, graph, self._accessors, limits)

    def existing_uv(self) -> NDArray[np.float64]:
        """The first UV set at each corner of the soup (F x 3 x 2), V up from 0 downwards.

        Raises `UnusableUvError` where a primitive has none, or one that is not finite.
        """
        return read_corner_uv(self.soup, self._accessors)

    def face_weights(self, materials: Mapping[str, float]) -> NDArray[np.float64] | None:
        """The weight of each face (F) by the name of its material, 1 for others; or none at all.

        Raises `OptionError` for a name that no material of the soup has.
        """
        return face_weights(self._root, self.soup.pieces, materials)

    def write(
        self,
        corner_uv: NDArray[np.float32],
        existing_uv: ExistingUv = "keep",
        *,
        compress: Compression = "none",
        extras: Mapping[str, Any] | None = None,
    ) -> bytes:
        """The GLB with UVs for each corner of the soup (F x 3 x 2, V up).

        extras: added to those of the asset.
        """
        draft = Draft(self._root.value, self._buffers, self._left, self._removable)
        write_atlas(draft, self._accessors, self.soup, corner_uv, existing_uv)
        if extras:
            draft.add_extras(extras)
        return draft.finish(self._others, compress=compress)


def _check_version(root: Cursor) -> None:
    asset = root.need("asset")
    version = asset.need("version")
    if version.as_text().partition(".")[0] != "2":
        version.fail(f"glTF version {version.value[:20]!r}, only 2 is read")
    minimum = asset.get("minVersion")
    if minimum is not None and minimum.as_text() != "2.0":
        minimum.fail(f"needs glTF {minimum.value[:20]!r}, 2.0 is read")
