"""An own judge of atlases for the engine's tests: it shares no code with the engine."""

from __future__ import annotations

import numpy as np
import shapely

GRID = 2.0**24
"""UVs are multiples of 1 / GRID."""

ROUNDING_UV = 2.0 / GRID
"""A triangle of less height is what rounding left of it: it has no meaningful winding."""

DEPTH_UV = 1e-6
"""Triangles that reach less far into each other only touch."""


def areas_3d(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = np.moveaxis(positions[faces], 1, 0)
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=-1)


def valid_faces(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Faces with an area that single precision can tell from none."""
    used = positions[np.unique(faces)]
    diagonal_squared = ((used.max(axis=0) - used.min(axis=0)) ** 2).sum()
    return areas_3d(positions, faces) > 1e-14 * diagonal_squared


def signed_areas(uv: np.ndarray) -> np.ndarray:
    e1, e2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    return 0.5 * (e1[:, 0] * e2[:, 1] - e1[:, 1] * e2[:, 0])


def flipped(uv: np.ndarray, valid: np.ndarray) -> np.ndarray:
    """Numbers of valid faces wound clockwise in UV, or without area where there is room for one."""
    longest = np.linalg.norm(uv - np.roll(uv, 1, axis=1), axis=-1).max(axis=1)
    area = signed_areas(uv)
    meaningful = valid & (longest > ROUNDING_UV) & (2 * np.abs(area) > ROUNDING_UV * longest)
    return np.flatnonzero(meaningful & (area <= 0))


def overlaps(uv: np.ndarray) -> list[tuple[int, int]]:
    """Pairs of triangles that penetrate each other by more than DEPTH_UV in every direction."""
    area = signed_areas(uv)
    solid = np.flatnonzero(area != 0)
    triangles = np.where((area < 0)[:, None, None], uv[:, ::-1], uv)[solid]
    tree = shapely.STRtree(shapely.polygons(triangles))
    first, second = tree.query(tree.geometries)
    first, second = first[first < second], second[first < second]
    depth = np.full(len(first), np.inf)
    for own, other in ((first, second), (second, first)):
        for side in range(3):
            start = triangles[own, side]
            along = triangles[own, (side + 1) % 3] - start
            along = along / np.linalg.norm(along, axis=-1, keepdims=True)
            to = triangles[other] - start[:, None]
            inward = along[:, None, 0] * to[..., 1] - along[:, None, 1] * to[..., 0]
            depth = np.minimum(depth, inward.max(axis=1))
    deep = depth > DEPTH_UV
    return [(int(solid[a]), int(solid[b])) for a, b in zip(first[deep], second[deep], strict=True)]


def stretches(positions: np.ndarray, faces: np.ndarray, uv: np.ndarray) -> tuple[np.ndarray, ...]:
    """Singular values of the maps from the triangles in space to UV, larger and smaller."""
    a, b, c = np.moveaxis(positions[faces], 1, 0)
    e1, e2 = b - a, c - a
    length = np.linalg.norm(e1, axis=-1)
    x = (e1 * e2).sum(axis=-1) / length
    y = np.linalg.norm(np.cross(e1, e2), axis=-1) / length
    f1, f2 = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    du = f1 / length[:, None]
    dv = (f2 - du * x[:, None]) / y[:, None]
    values = np.linalg.svd(np.stack([du, dv], axis=-1), compute_uv=False)
    return values[:, 0], values[:, 1]


def area_distortion(areas: np.ndarray, uv: np.ndarray) -> float:
    """Eq. 1 of the paper over faces of the given areas in space: one chart's valid faces."""
    flat = np.abs(signed_areas(uv))
    if not flat.sum() > 0:
        return 1.0
    ratio = flat / areas * (areas.sum() / flat.sum())
    with np.errstate(divide="ignore"):
        return float(np.minimum(np.maximum(ratio, 1 / ratio), 10).mean())


def angular_score(positions: np.ndarray, faces: np.ndarray, uv: np.ndarray) -> float:
    """Mean over the faces of the score that all rotations of a chart have on average."""
    large, small = stretches(positions, faces, uv)
    return float(np.mean(1 - 2 / np.pi * np.arcsin((large**2 - small**2) / (large**2 + small**2))))


def uv_islands(uv: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Island of each face: joined across sides of equal points (F x 3) and equal UVs."""
    parent = np.arange(len(uv))

    def root(face: int) -> int:
        while parent[face] != face:
            parent[face] = parent[parent[face]]
            face = parent[face]
        return face

    seen: dict[tuple[object, ...], int] = {}
    for face in range(len(uv)):
        ends = [(int(points[face, k]), *uv[face, k]) for k in range(3)]
        for k in range(3):
            side = tuple(sorted((ends[k], ends[(k + 1) % 3])))
            other = seen.setdefault(side, face)
            parent[max(root(face), root(other))] = min(root(face), root(other))
    return np.array([root(face) for face in range(len(uv))])


def least_gutter(uv: np.ndarray, chart: np.ndarray) -> float:
    """Smallest distance between the triangles of two charts, in UV units; inf for one chart."""
    shapes = [
        shapely.geometrycollections(shapely.polygons(uv[chart == c])) for c in np.unique(chart)
    ]
    least = np.inf
    for i, shape in enumerate(shapes[:-1]):
        least = min(least, float(shapely.distance(shape, shapes[i + 1 :]).min()))
    return least


def assert_sound(
    positions: np.ndarray,
    faces: np.ndarray,
    atlas: object,
    *,
    max_area_distortion: float = 1.25,
    min_gutter_uv: float = 0.0,
) -> None:
    """What holds for every atlas, whatever the mesh."""
    uv = np.asarray(atlas.corner_uv)  # type: ignore[attr-defined]
    chart = np.asarray(atlas.chart)  # type: ignore[attr-defined]
    table = atlas.charts  # type: ignore[attr-defined]
    assert uv.shape == (len(faces), 3, 2)
    assert uv.dtype == np.float32
    uv = uv.astype(np.float64)
    assert np.isfinite(uv).all()
    assert uv.min() >= 0
    assert uv.max() <= 1
    assert not (uv * GRID % 1).any(), "a UV off the grid"

    assert chart.shape == (len(faces),)
    counts = np.bincount(chart, minlength=len(table["faces"]))
    np.testing.assert_array_equal(counts, table["faces"], "faces of the charts")
    assert counts.min() > 0, "a chart without a face"

    valid, areas = valid_faces(positions, faces), areas_3d(positions, faces)
    assert not len(flipped(uv, valid)), f"flipped faces {flipped(uv, valid)[:5]}"
    pairs = overlaps(uv)
    assert not pairs, f"{len(pairs)} overlaps: {pairs[:5]}"

    _, points = np.unique(positions, axis=0, return_inverse=True)
    points = points.reshape(-1)[faces]
    whole = (points[:, 0] != points[:, 1]) & (points[:, 1] != points[:, 2])
    whole &= points[:, 2] != points[:, 0]
    islands = uv_islands(uv, points)
    for number in range(len(counts)):
        inside = (chart == number) & whole
        assert len(np.unique(islands[inside])) == 1, f"chart {number} is not connected"
        if inside.sum() > 1:
            counted = inside & valid
            distortion = area_distortion(areas[counted], uv[counted])
            assert distortion <= max_area_distortion * (1 + 1e-4), f"chart {number}: {distortion}"
    if min_gutter_uv > 0:
        assert least_gutter(uv, chart) >= min_gutter_uv
