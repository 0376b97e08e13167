"""The charts of a UV set: faces joined where they share an edge on the surface and in UV."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from partuv_worker.measure import signed_areas_2d, welded

Array = NDArray[Any]

_LARGEST_FOLD = 0.1  # of a chart's area in UV; with more, its two sides are charts of their own


class _Sides(NamedTuple):
    """Sides of faces, an element each; equal `edge`: the same two ends, in space and in UV."""

    edge: Array
    face: Array
    forward: Array  # whether the face runs along its edge from the lower corner to the higher
    winding: Array  # of the face in UV: -1, 1, or 0 without area

    def take(self, chosen: Array | slice) -> _Sides:
        """These of them."""
        return _Sides(*(column[chosen] for column in self))


def find_charts(
    positions: Array, faces: Array, corner_uv: Array, primitive: Array, mesh: Array
) -> NDArray[np.int32]:
    """The chart of each face, numbered by first faces. O(F log F).

    corner_uv: F x 3 x 2, compared exactly. primitive, mesh: F; charts may cross the primitives of a
    mesh, but faces that lie in the same place join those of their own primitive first. Faces join
    across an edge that has one of them on each side in UV. Where they lie on the same side, the
    chart is folded over: it ends there, as between mirrored halves that share their texels, unless
    all that is folded over is a small share of it. An edge of more than two faces joins those two
    that are wound alike and run along it in opposite directions, if there are just two.
    """
    point = welded(positions)[faces]
    corner = welded(np.dstack([point, corner_uv]).reshape(-1, 3)).reshape(-1, 3)
    start, end = corner.ravel(), np.roll(corner, -1, axis=1).ravel()
    face = np.repeat(np.arange(len(faces)), 3)
    area = signed_areas_2d(corner_uv)
    winding = np.sign(area).astype(np.int8)[face]
    low, high = np.minimum(start, end), np.maximum(start, end)
    sides = _Sides(_numbered(low, high), face, start < end, winding).take(start != end)

    own = sides._replace(edge=_numbered(sides.edge, primitive[sides.face]))
    alone = np.bincount(own.edge)[own.edge] == 1
    border = sides.take(alone)
    border = border._replace(edge=_numbered(border.edge, mesh[border.face]))
    joined = zip(_joined(own), _joined(border), strict=True)
    plain, folded = (np.concatenate(pairs) for pairs in joined)
    label = connected(len(faces), plain[:, 0], plain[:, 1])
    if len(folded):
        whole = connected(len(faces), *label[folded].T)[label]
        label = np.where(_is_one_sheet(area, whole)[whole], whole, label)
    return np.unique(label, return_inverse=True)[1].astype(np.int32)


def connected(count: int, first: Array, second: Array) -> NDArray[np.int64]:
    """The lowest number among all that each of 0..count-1 is linked with. O((n + m) log n)."""
    label = np.arange(count)
    while True:
        one, other = label[first], label[second]
        if np.array_equal(one, other):
            return label
        np.minimum.at(label, np.maximum(one, other), np.minimum(one, other))
        while not np.array_equal(label, label[label]):
            label = label[label]


def _is_one_sheet(area: Array, label: Array) -> Array:
    """Of each label: whether most of its faces' area has one sign."""
    left, right = (np.bincount(label, np.maximum(sign * area, 0)) for sign in (1, -1))
    one_sheet: Array = np.minimum(left, right) <= _LARGEST_FOLD * (left + right)
    return one_sheet


def _joined(sides: _Sides) -> tuple[Array, Array]:
    """Pairs (n x 2) of faces that go on across an edge, and of those that fold back there."""
    of_edge = np.bincount(sides.edge, minlength=1)[sides.edge]
    first, second = _pairs(sides.take(of_edge == 2))
    # The side of the edge that a face lies on in UV: left of it where it runs forward.
    left = [np.where(one.forward, one.winding, -one.winding) for one in (first, second)]
    plain = left[0] * left[1] <= 0

    crowd = sides.take((of_edge > 2) & (sides.winding != 0))
    crowd = crowd._replace(edge=_numbered(crowd.edge, crowd.winding))
    alike = np.bincount(crowd.edge, minlength=1)[crowd.edge] == 2
    third, fourth = _pairs(crowd.take(alike))
    opposite = third.forward != fourth.forward
    pairs = np.stack([first.face, second.face], axis=1)
    more = np.stack([third.face, fourth.face], axis=1)
    folded = ~plain & (first.forward != second.forward)
    return np.concatenate([pairs[plain], more[opposite]]), pairs[folded]


def _numbered(*columns: Array) -> Array:
    return welded(np.column_stack(columns))


def _pairs(sides: _Sides) -> tuple[_Sides, _Sides]:
    """The first and the second sides of edges that have two each."""
    ordered = sides.take(np.argsort(sides.edge, kind="stable"))
    return ordered.take(slice(0, None, 2)), ordered.take(slice(1, None, 2))
