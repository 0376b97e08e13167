"""Small meshes for tree tests, and the part trees' formulas without any data structure."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

SHARED = Path(__file__).resolve().parents[3] / "shared"

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


def grid(columns: int, rows: int, seed: int, roughness: float) -> tuple[Floats, Ints]:
    """A height field of 2 * columns * rows triangles, jittered so that no two scores are equal."""
    rng = np.random.default_rng(seed)
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0), indexing="ij")
    positions = np.stack([x, y, np.zeros_like(x)], axis=-1).reshape(-1, 3)
    positions += rng.uniform(-0.3, 0.3, positions.shape) * [1.0, 1.0, roughness]
    corner = np.arange((columns + 1) * (rows + 1)).reshape(columns + 1, rows + 1)
    a, b, c, d = (
        corner[:-1, :-1].ravel(),
        corner[1:, :-1].ravel(),
        corner[1:, 1:].ravel(),
        corner[:-1, 1:].ravel(),
    )
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    return positions, faces


def sheared_grid(columns: int, rows: int) -> tuple[Floats, Ints]:
    """A flat grid of 2 * columns * rows triangles of equal area."""
    positions, faces = grid(columns, rows, 0, 0.0)
    corner = np.arange((columns + 1) * (rows + 1))
    positions[:, 0], positions[:, 1] = corner // (rows + 1), corner % (rows + 1)
    return positions, faces


def dumbbell() -> tuple[Floats, Ints]:
    """Two balls that meet in a ring at x = 0: a closed surface with one concave crease."""
    rings, around = 24, 16
    x = np.linspace(-1.25, 1.25, rings + 1)
    radius = np.sqrt(0.7**2 - (np.abs(x) - 0.6) ** 2)
    angle = 2 * np.pi * np.arange(around) / around
    sides = np.stack(
        [
            np.repeat(x, around),
            np.outer(radius, np.cos(angle)).ravel(),
            np.outer(radius, np.sin(angle)).ravel(),
        ],
        axis=1,
    )
    positions = np.concatenate([sides, [[-1.3, 0, 0], [1.3, 0, 0]]])
    faces = []
    for ring, i in itertools.product(range(rings), range(around)):
        a, b = ring * around + i, ring * around + (i + 1) % around
        faces += [(a, b + around, b), (a, a + around, b + around)]
    first, last = len(sides), len(sides) + 1
    for i in range(around):
        faces.append((first, i, (i + 1) % around))
        faces.append((last, rings * around + (i + 1) % around, rings * around + i))
    return positions, np.array(faces, np.int32)


def tetrahedra(count: int, seed: int) -> tuple[Floats, Ints]:
    """Closed tetrahedra of different sizes scattered in a box, each a component of four faces."""
    rng = np.random.default_rng(seed)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    sides = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    size = rng.uniform(0.1, 1.0, (count, 1, 1))
    positions = (corners * size + rng.uniform(0, 50, (count, 1, 3))).reshape(-1, 3)
    faces = (sides + 4 * np.arange(count)[:, None, None]).reshape(-1, 3)
    return positions, faces.astype(np.int32)


def shared_sides(faces: Ints) -> list[tuple[int, int, int, int]]:
    """(face, face, vertex, vertex) for each side that exactly two faces share."""
    owners: dict[tuple[int, int], list[int]] = {}
    for face, corners in enumerate(faces):
        for s in range(3):
            a, b = sorted((int(corners[s]), int(corners[(s + 1) % 3])))
            owners.setdefault((a, b), []).append(face)
    return [(f[0], f[1], *side) for side, f in owners.items() if len(f) == 2]


def face_areas(positions: Floats, faces: Ints) -> Floats:
    p = positions[faces]
    return np.linalg.norm(np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]), axis=1) / 2


def conductances(
    positions: Floats, faces: Ints, convex_weight: float
) -> tuple[dict[tuple[int, int], float], Floats]:
    """Edge sums and area shares of normalised-boundary merging, straight from its definition."""
    p = positions[faces]
    cross = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    normal = cross / np.linalg.norm(cross, axis=1, keepdims=True)
    area = face_areas(positions, faces)
    centroid = p.mean(axis=1)
    lengths, creases, pairs = [], [], []
    for i, j, a, b in shared_sides(faces):
        concave = (centroid[j] - centroid[i]) @ (normal[i] - normal[j]) > 0
        lengths.append(np.linalg.norm(positions[a] - positions[b]) / np.sqrt(area.sum()))
        creases.append((1.0 if concave else convex_weight) * (1 - normal[i] @ normal[j]))
        pairs.append((min(i, j), max(i, j)))
    sigma = np.dot(lengths, creases) / np.sum(lengths) + 1e-6
    sums: dict[tuple[int, int], float] = {}
    for pair, length, crease in zip(pairs, lengths, creases, strict=True):
        similarity = max(0.02, np.exp(-2 * crease / sigma))
        sums[pair] = sums.get(pair, 0.0) + length * similarity
    return sums, area / area.sum()


def four_digits(score: float) -> np.float32:
    """A score as the engine compares it: equal scores must not be told apart by rounding."""
    bits = np.float32(score).view(np.uint32)
    return np.uint32((int(bits) + 1024) >> 11 << 11).view(np.float32)


def greedy_merges(sums: dict[tuple[int, int], float], area: Floats) -> list[tuple[int, int]]:
    """Merge the pair with the largest normalised boundary until no two regions touch."""
    sums, areas = dict(sums), dict(enumerate(area))
    merges = []
    for new in itertools.count(len(area)):
        if not sums:
            return merges
        a, b = min(
            sums, key=lambda p: (-four_digits(sums[p] * (1 / areas[p[0]] + 1 / areas[p[1]])), p)
        )
        merges.append((a, b))
        areas[new] = areas.pop(a) + areas.pop(b)
        moved: dict[tuple[int, int], float] = {}
        for pair, weight in sums.items():
            x, y = (new if node in (a, b) else node for node in pair)
            if x != y:
                key = (min(x, y), max(x, y))
                moved[key] = moved.get(key, 0.0) + weight
        sums = moved
    raise AssertionError("unreachable")


def ward_costs(
    means: Floats, areas: Floats, joins: Sequence[tuple[int, int]]
) -> Iterator[tuple[float, float]]:
    """Of each join of weighted points, numbered as made, its cost and that of the cheapest then."""
    clusters = {i: (areas[i], means[i]) for i in range(len(areas))}

    def cost(a: int, b: int) -> float:
        (p, u), (q, v) = clusters[a], clusters[b]
        return float(p * q / (p + q) * np.sum((u - v) ** 2))

    for new, (a, b) in enumerate(joins, len(areas)):
        yield cost(a, b), min(cost(*pair) for pair in itertools.combinations(clusters, 2))
        (p, u), (q, v) = clusters.pop(a), clusters.pop(b)
        clusters[new] = (p + q, (p * u + q * v) / (p + q))
