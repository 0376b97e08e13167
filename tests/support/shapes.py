"""Meshes with known answers: positions V x 3 (float64) and faces F x 3 (int32)."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Mesh = tuple[np.ndarray, np.ndarray]


def grid(
    rows: int,
    columns: int,
    place: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray, np.ndarray]],
    *,
    join: str = "",
) -> Mesh:
    """A grid of two triangles per cell; ``place`` maps (s, t) in [0, 1] to x, y, z.

    join: "rows", "columns" or both: where the last line of vertices is the first one.
    """
    down = rows if "rows" in join else rows + 1
    across = columns if "columns" in join else columns + 1
    s, t = np.meshgrid(np.arange(down) / rows, np.arange(across) / columns, indexing="ij")
    positions = np.stack(np.broadcast_arrays(*place(s, t)), axis=-1).reshape(-1, 3)
    number = np.arange(down * across).reshape(down, across)
    number = np.pad(number, ((0, rows + 1 - down), (0, columns + 1 - across)), mode="wrap")
    return positions.astype(np.float64), _two_per_cell(number)


def _two_per_cell(number: np.ndarray) -> np.ndarray:
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    faces = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=-2)
    return faces.reshape(-1, 3).astype(np.int32)


def plane(side: int) -> Mesh:
    return grid(side, side, lambda s, t: (s, t, 0 * s))


def strip(along: int, across: int, width: float, length: float = 5.0) -> Mesh:
    """A flat strip, far longer than wide."""
    return grid(along, across, lambda s, t: (length * s, width * t, 0 * s))


def plane_with_flat_face(side: int) -> Mesh:
    """A plane with a vertex on the middle of an edge; a face without area closes the gap."""
    positions, faces = plane(side)
    at = 2 * side * side // 3
    a, b, c = faces[at]
    middle = len(positions)
    faces[at] = a, middle, c
    closing = np.array([[middle, b, c], [a, b, middle]], np.int32)
    return (
        np.concatenate([positions, [(positions[a] + positions[b]) / 2]]),
        np.concatenate([faces, closing]),
    )


def with_needles(mesh: Mesh, needles: int, height: float) -> Mesh:
    """The mesh with some faces, evenly spread, cut in three: two and a needle along a side."""
    positions, faces = mesh
    points, triangles = list(positions), faces.tolist()
    step = len(faces) // needles
    for at in range(0, step * needles, step):
        a, b, c = triangles[at]
        middle = (points[a] + points[b]) / 2
        inward = (points[c] - middle) / np.linalg.norm(points[c] - middle)
        tip = len(points)
        points.append(middle + height * inward)
        triangles[at] = [a, tip, c]
        triangles += [[tip, b, c], [a, b, tip]]
    return np.array(points), np.array(triangles, np.int32)


def bent_sheet(side: int) -> Mesh:
    """A quarter of a cylinder of length 1: developable."""
    return grid(side, side, lambda s, t: (np.cos(np.pi / 2 * s), np.sin(np.pi / 2 * s), t))


def flat_ring(around: int, across: int, inner: float, turn: float = 1.0) -> Mesh:
    """A disk of radius 1 without its middle, or a share of its turn."""

    def place(s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        angle, radius = 2 * np.pi * turn * s, 1 - (1 - inner) * t
        return radius * np.cos(angle), radius * np.sin(angle), 0 * s * t

    return grid(around, across, place, join="rows" if turn == 1.0 else "")


def tube(around: int, along: int, height: float = 2.0) -> Mesh:
    """A cylinder without its ends."""

    def place(s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        return np.cos(2 * np.pi * s), np.sin(2 * np.pi * s), height * t

    return grid(around, along, place, join="rows")


def cylinder(around: int, along: int) -> Mesh:
    """A tube with a fan of triangles on either end."""
    positions, faces = tube(around, along)
    number = np.arange(around * (along + 1)).reshape(around, along + 1)
    low, high = number[:, 0], number[:, -1]
    centre_low, centre_high = len(positions), len(positions) + 1
    fans = [
        np.stack([np.roll(low, -1), low, np.full(around, centre_low)], axis=-1),
        np.stack([high, np.roll(high, -1), np.full(around, centre_high)], axis=-1),
    ]
    centres = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
    return np.concatenate([positions, centres]), np.concatenate([faces, *fans]).astype(np.int32)


def cone(around: int, height: float = 1.5) -> Mesh:
    """The mantle of a cone."""
    angle = 2 * np.pi * np.arange(around) / around
    rim = np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=-1)
    corner = np.arange(around)
    faces = np.stack([corner, np.roll(corner, -1), np.full(around, around)], axis=-1)
    return np.concatenate([rim, [[0.0, 0.0, height]]]), faces.astype(np.int32)


def torus(around: int, along: int, thickness: float = 0.4) -> Mesh:
    def place(s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        reach = 1 + thickness * np.cos(2 * np.pi * t)
        turn = 2 * np.pi * s
        return reach * np.cos(turn), reach * np.sin(turn), thickness * np.sin(2 * np.pi * t)

    return grid(around, along, place, join="rows columns")


def moebius(around: int, across: int) -> Mesh:
    """A strip with half a twist: one side, so that some edge joins opposed faces."""

    def place(s: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        turn, off = 2 * np.pi * s, 0.3 * (2 * t - 1)
        reach = 1 + off * np.cos(turn / 2)
        return reach * np.cos(turn), reach * np.sin(turn), off * np.sin(turn / 2)

    positions, faces = grid(around, across, place)
    number = np.arange(len(positions)).reshape(around + 1, across + 1)
    number[-1] = number[0, ::-1]
    return positions, number.reshape(-1).astype(np.int32)[faces]


def icosphere(levels: int) -> Mesh:
    """The unit sphere: an icosahedron, each face split in four ``levels`` times."""
    golden = (1 + 5**0.5) / 2
    points = [(0, u, v * golden) for u in (-1, 1) for v in (-1, 1)]
    points = points + [(y, z, x) for x, y, z in points] + [(z, x, y) for x, y, z in points]
    positions = np.array(points, dtype=float) / np.hypot(1, golden)
    distance = np.linalg.norm(positions[:, None] - positions[None], axis=-1)
    near = (distance > 0) & (distance < 1.1 * distance[distance > 0].min())
    faces = np.array(
        [
            (a, b, c)
            for a in range(12)
            for b in range(a + 1, 12)
            for c in range(b + 1, 12)
            if near[a, b] and near[b, c] and near[a, c]
        ]
    )
    inward = np.linalg.det(positions[faces]) < 0
    faces[inward] = faces[inward][:, ::-1]
    for _ in range(levels):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, which = np.unique(edges, axis=0, return_inverse=True)
        middle = positions[unique].sum(axis=1)
        ab, bc, ca = (which.reshape(-1, 3) + len(positions)).T
        positions = np.concatenate([positions, middle / np.linalg.norm(middle, axis=1)[:, None]])
        a, b, c = faces.T
        split = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = np.concatenate([np.stack(corners, axis=-1) for corners in split])
    return positions, faces.astype(np.int32)


def lump() -> Mesh:
    """A closed shape without symmetry."""
    positions, faces = icosphere(3)
    x, y, z = positions.T
    radius = 1 + 0.25 * np.sin(3 * x) * np.cos(2 * y + 1) + 0.2 * np.sin(4 * z + x)
    return positions * radius[:, None], faces


def hemisphere(levels: int) -> Mesh:
    """The faces of the icosphere above the equator (of an axis that splits no face badly)."""
    positions, faces = icosphere(levels)
    return positions, faces[positions[faces].mean(axis=1)[:, 2] > 0]


def blocks(solid: np.ndarray) -> Mesh:
    """The surface of the unit cells that are True in a 3D array, two triangles per square."""
    filled = np.pad(solid, 1)
    corners: list[np.ndarray] = []
    for axis in range(3):
        u, v = np.eye(3, dtype=int)[[(axis + 1) % 3, (axis + 2) % 3]]
        step = np.eye(3, dtype=int)[axis]
        for out in (True, False):
            bare = filled & ~np.roll(filled, -1 if out else 1, axis=axis)
            origin = np.argwhere(bare) + (step if out else 0)
            square = [origin, origin + u, origin + u + v, origin + v]
            corners.append(np.stack(square if out else square[::-1], axis=1))
    squares = np.concatenate(corners)
    positions, number = np.unique(squares.reshape(-1, 3), axis=0, return_inverse=True)
    number = number.reshape(-1, 4)
    faces = np.concatenate([number[:, [0, 1, 2]], number[:, [0, 2, 3]]])
    return positions.astype(np.float64), faces.astype(np.int32)


def cube(cells: int = 1) -> Mesh:
    return blocks(np.ones((cells, cells, cells), dtype=bool))


def plate_with_holes(holes: int) -> Mesh:
    """A flat block pierced ``holes`` times: a surface of that genus."""
    solid = np.ones((2 * holes + 1, 3, 1), dtype=bool)
    solid[1::2, 1] = False
    return blocks(solid)


def l_sheet() -> Mesh:
    """A flat L of unit squares with a hole of one square in its corner."""
    present = np.zeros((6, 6), dtype=bool)
    present[:3], present[:, :3] = True, True
    present[1, 1] = False
    number = np.arange(49).reshape(7, 7)
    faces = _two_per_cell(number).reshape(6, 6, 2, 3)[present].reshape(-1, 3)
    x, y = np.divmod(np.arange(49.0), 7)
    return np.stack([x, y, 0 * x], axis=-1), faces


def beside(*meshes: Mesh) -> Mesh:
    """Meshes in a row, as one."""
    positions = [xyz + np.array([4.0 * i, 0, 0]) for i, (xyz, _) in enumerate(meshes)]
    firsts = np.cumsum([0, *(len(xyz) for xyz, _ in meshes)])
    faces = [of_mesh + first for (_, of_mesh), first in zip(meshes, firsts, strict=False)]
    return np.concatenate(positions), np.concatenate(faces).astype(np.int32)


def loose_triangles(count: int, seed: int = 0) -> Mesh:
    """Triangles of random shapes that have no vertex in common."""
    random = np.random.default_rng(seed)
    corners = random.normal(size=(count, 1, 3)) * 10 + random.normal(size=(count, 3, 3))
    return corners.reshape(-1, 3), np.arange(3 * count, dtype=np.int32).reshape(-1, 3)


def wavy(side: int, seed: int = 0, noise: float = 0.0) -> Mesh:
    """A sheet with hills, and noise in units of its cells."""
    positions, faces = grid(side, side, lambda s, t: (s, t, 0.15 * np.sin(9 * s) * np.cos(7 * t)))
    random = np.random.default_rng(seed)
    return positions + noise / side * random.normal(size=positions.shape), faces


def shuffled(
    positions: np.ndarray, faces: np.ndarray, seed: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """The mesh with its vertices, faces and corners in another order, and the orders of the two."""
    random = np.random.default_rng(seed)
    vertices, order = random.permutation(len(positions)), random.permutation(len(faces))
    number = np.argsort(vertices).astype(np.int32)
    corners = (random.integers(0, 3, (len(faces), 1)) + np.arange(3)) % 3
    renamed = np.take_along_axis(number[faces][order], corners, axis=1)
    return positions[vertices], renamed, order, corners
