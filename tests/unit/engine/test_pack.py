"""Packing of given charts: gutter, border, parts and tiles, measured as written."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from partuv_engine import Context, EngineError, Grouping, PackOptions, pack
from shapely.geometry import Polygon


def polygons(seed, count):
    """Fans of triangles, thin and thick: points, triangles, chart of each triangle."""
    random = np.random.default_rng(seed)
    points, faces, chart = [], [], []
    for number in range(count):
        corners = int(random.integers(3, 14))
        angle = np.linspace(0, 2 * np.pi, corners, endpoint=False)
        reach = random.uniform(0.3, 1.3, corners) * np.exp(random.uniform(0, 2))
        ring = np.stack([reach * np.cos(angle), reach * np.sin(angle) * random.uniform(0.1, 1)], 1)
        first = sum(map(len, points))
        points.append(np.vstack([[0, 0], ring]) + random.uniform(-9, 9, 2))
        for k in range(corners):
            faces.append([first, first + 1 + k, first + 1 + (k + 1) % corners])
            chart.append(number)
    return np.concatenate(points), np.array(faces, np.int32), np.array(chart, np.int32)


def options(**values):
    chosen = PackOptions()
    for name, value in values.items():
        setattr(chosen, name, value)
    return chosen


def areas(result, chart, resolution):
    """The charts in their tiles as shapes, in texels."""
    triangles = np.asarray(result.corner_uv, np.float64) * resolution
    count = chart.max() + 1
    return [
        shapely.union_all([Polygon(t) for t in triangles[chart == number]])
        for number in range(count)
    ]


def least_distance(shapes):
    """Between any two of the shapes."""
    tree = shapely.STRtree(shapes)
    pairs = tree.query(shapes, predicate="dwithin", distance=64)
    pairs = pairs[:, pairs[0] < pairs[1]]
    distances = shapely.distance(np.take(shapes, pairs[0]), np.take(shapes, pairs[1]))
    return distances.min(initial=64)


def check_tiles(result, chart, *, resolution, gutter, border):
    """Gutter and border of every tile."""
    shapes = np.array(areas(result, chart, resolution))
    for tile in range(result.tile.max() + 1):
        own = shapes[result.tile == tile]
        bounds = shapely.total_bounds(own)
        assert bounds[:2].min() >= border
        assert bounds[2:].max() <= resolution - border
        assert least_distance(own) >= gutter
        reached = result.tiles["gutter_texels"][tile]
        assert reached >= gutter
        if reached < 64:
            assert reached == pytest.approx(least_distance(own), abs=0.02)


@settings(max_examples=12, deadline=None)
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(1, 25),
    resolution=st.sampled_from([256, 1000, 4096]),
    gutter=st.sampled_from([0.0, 1.5, 4.0]),
    border=st.sampled_from([-1.0, 0.0, 7.0]),
    mips=st.sampled_from([0, 2]),
    snap=st.booleans(),
    tiles=st.sampled_from([1, 3]),
)
def test_gutter_and_border_hold_on_what_is_written(
    seed, count, resolution, gutter, border, mips, snap, tiles
):
    uv, faces, chart = polygons(seed, count)
    chosen = options(
        resolution=resolution,
        gutter_texels=gutter,
        border_texels=border,
        mip_levels=mips,
        snap_to_texels=snap,
        tiles=tiles,
    )
    result = pack(uv, faces, chart, chosen, Context(2), part=np.arange(count, dtype=np.int32) // 3)
    check_tiles(
        result,
        chart,
        resolution=resolution,
        gutter=gutter * 2**mips,
        border=(gutter / 2 if border < 0 else border) * 2**mips,
    )
    assert np.unique(result.scale).size == 1


def test_placements_are_turns_of_the_given_charts():
    uv, faces, chart = polygons(3, 12)
    result = pack(uv, faces, chart, options(), Context(2))
    turn, scale = result.rotation_rad[chart], result.scale[chart]
    given_uv = uv[faces]
    sides = given_uv[:, 1] - given_uv[:, 0]
    x = scale * (np.cos(turn) * sides[:, 0] - np.sin(turn) * sides[:, 1])
    y = scale * (np.sin(turn) * sides[:, 0] + np.cos(turn) * sides[:, 1])
    written = result.corner_uv[:, 1] - result.corner_uv[:, 0]
    np.testing.assert_allclose(written, np.stack([x, y], 1), atol=1e-6)


@pytest.mark.parametrize(
    "values",
    [{}, {"tiles": 3}, {"group_by_part": Grouping.strict}, {"texel_density": 20.0}],
    ids=str,
)
def test_any_number_of_threads_gives_the_same_bytes(values):
    uv, faces, chart = polygons(5, 24)
    part = np.arange(24, dtype=np.int32) // 4
    packed = [
        pack(uv, faces, chart, options(**values), Context(threads), part=part).corner_uv.tobytes()
        for threads in (1, 2, 4)
    ]
    assert len(set(packed)) == 1


def test_mirrored_charts_are_packed_and_stay_mirrored():
    uv, faces, chart = polygons(6, 10)
    mirrored = uv * (-1, 1)
    result = pack(mirrored, faces, chart, options(), Context(2))
    check_tiles(result, chart, resolution=1024, gutter=4, border=2)
    a, b, c = np.moveaxis(np.asarray(result.corner_uv, np.float64), 1, 0)
    u, v = b - a, c - a
    assert (u[:, 0] * v[:, 1] < u[:, 1] * v[:, 0]).all()


@pytest.mark.parametrize(("seed", "large"), [(1, 14), (6, 8)])
def test_crumbs_too_many_to_be_searched_go_between_large_charts_that_are(seed, large):
    points, faces, chart = polygons(seed, large)
    crumbs = 300
    corners = np.tile([[0.0, 0.0], [0.35, 0.0], [0.0, 0.35]], (crumbs, 1))
    mesh = (
        np.concatenate([points, corners]),
        np.concatenate([faces, len(points) + np.arange(3 * crumbs).reshape(-1, 3)], dtype=np.int32),
        np.concatenate([chart, large + np.arange(crumbs)], dtype=np.int32),
    )
    quick, searched = (pack(*mesh, options(effort=e), Context(2)) for e in (0.0, 1.0))
    check_tiles(searched, mesh[2], resolution=1024, gutter=4, border=2)
    assert searched.efficiency > 1.15 * quick.efficiency
    alone = pack(*mesh, options(effort=1.0), Context(1))
    np.testing.assert_array_equal(alone.corner_uv, searched.corner_uv)


def test_snapped_boxes_begin_at_corners_of_texels():
    uv, faces, chart = polygons(7, 15)
    result = pack(uv, faces, chart, options(snap_to_texels=True), Context(2))
    for shape in areas(result, chart, 1024):
        assert shape.bounds[0] == round(shape.bounds[0])
        assert shape.bounds[1] == round(shape.bounds[1])


def test_weights_are_texel_densities():
    uv, faces, chart = polygons(8, 8)
    weight = np.array([1, 1, 2, 1, 0.5, 1, 1, 1.0])
    result = pack(uv, faces, chart, options(), Context(2), weight=weight)
    np.testing.assert_allclose(result.scale / result.scale[0], weight)
    check_tiles(result, chart, resolution=1024, gutter=4, border=2)


def spread(result, chart, part):
    """Mean distance of charts to the middle of their part, in texels."""
    middles = np.array([shape.centroid.coords[0] for shape in areas(result, chart, 1024)])
    return np.mean(
        [
            np.linalg.norm(middles[part == p] - middles[part == p].mean(0), axis=1).mean()
            for p in np.unique(part)
        ]
    )


def test_near_brings_parts_together_at_little_cost():
    shares = []
    for seed in (2, 4):  # of the second no groups pack as densely: only swaps help there
        uv, faces, chart = polygons(seed, 20)
        part = np.random.default_rng(seed).integers(0, 4, 20).astype(np.int32)
        loose = pack(uv, faces, chart, options(), Context(2), part=part)
        near = pack(uv, faces, chart, options(group_by_part=Grouping.near), Context(2), part=part)
        check_tiles(near, chart, resolution=1024, gutter=4, border=2)
        assert near.scale[0] ** 2 >= 0.95 * loose.scale[0] ** 2
        shares.append(spread(near, chart, part) / spread(loose, chart, part))
    assert max(shares) < 0.85
    assert np.mean(shares) < 0.75


def test_strict_gives_every_part_a_rectangle():
    uv, faces, chart = polygons(4, 30)
    part = np.arange(30, dtype=np.int32) % 4
    result = pack(uv, faces, chart, options(group_by_part=Grouping.strict), Context(2), part=part)
    check_tiles(result, chart, resolution=1024, gutter=4, border=2)
    shapes = np.array(areas(result, chart, 1024))
    boxes = [shapely.box(*shapely.total_bounds(shapes[part == number])) for number in range(4)]
    assert least_distance(np.array(boxes)) >= 4


def test_tiles_share_the_area_and_take_parts_in_order():
    uv, faces, chart = polygons(9, 60)
    part = np.arange(60, dtype=np.int32) // 3
    result = pack(uv, faces, chart, options(tiles=4), Context(2), part=part)
    area = [shape.area for shape in areas(result, chart, 1024)]
    filled = np.bincount(result.tile, area)
    assert filled.size == 4
    assert filled.max() < 1.3 * filled.mean()
    assert (np.diff(result.tile) >= 0).all()
    assert result.tiles["charts"].sum() == 60


def test_one_tile_per_part():
    uv, faces, chart = polygons(10, 12)
    part = np.array([0, 0, 5, 5, 5, 7, 7, 7, 9, 9, 9, 9], np.int32)
    result = pack(uv, faces, chart, options(tiles=0), Context(2), part=part)
    assert result.tile.tolist() == [0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3]
    check_tiles(result, chart, resolution=1024, gutter=4, border=2)


def test_a_fixed_density_takes_as_many_tiles_as_it_needs():
    uv, faces, chart = polygons(11, 40)
    result = pack(uv, faces, chart, options(texel_density=60.0), Context(2))
    np.testing.assert_allclose(result.scale, 60 / 1024)
    assert result.tile.max() > 0
    check_tiles(result, chart, resolution=1024, gutter=4, border=2)
    covered = sum(shape.area for shape in areas(result, chart, 1024))
    assert result.tiles["covered_texels"].sum() == pytest.approx(covered, rel=0.01)


@pytest.mark.parametrize(
    ("values", "where"),
    [
        ({"resolution": 8}, "resolution"),
        ({"gutter_texels": float("nan")}, "gutter_texels"),
        ({"border_texels": 600.0}, "border_texels"),
        ({"mip_levels": 9}, "mip_levels"),
        ({"tiles": 101}, "tiles"),
        ({"rotations": 0}, "rotations"),
        ({"texel_density": 1.0, "tiles": 2}, "texel_density with tiles"),
        (
            {"texel_density": 1.0, "group_by_part": Grouping.near},
            "texel_density with group_by_part",
        ),
        ({"tiles": 0, "group_by_part": Grouping.strict}, "tiles per part with group_by_part"),
        ({"texel_density": 1e6}, "texel_density"),
    ],
    ids=str,
)
def test_refuses_options_that_do_not_fit(values, where):
    uv, faces, chart = polygons(1, 3)
    with pytest.raises(EngineError) as caught:
        pack(uv, faces, chart, options(**values), Context(1))
    assert caught.value.code == "invalid_option"
    assert caught.value.where.startswith(where)


def test_refuses_charts_that_make_no_sense():
    uv, faces, chart = polygons(1, 3)
    bad_uv = uv.copy()
    bad_uv[3, 1] = np.inf
    cases = [
        (bad_uv, faces, chart, {}, "non_finite_position"),
        (uv, faces + len(uv), chart, {}, "index_out_of_range"),
        (uv, faces, chart - 1, {}, "index_out_of_range"),
        (uv, faces, chart[:-1], {}, "index_out_of_range"),
        (uv, faces, chart, {"part": chart[:1]}, "index_out_of_range"),
        (uv, faces, chart, {"weight": np.array([1.0, 0.0, 1.0])}, "invalid_option"),
        (uv, faces[:0], chart[:0], {}, "empty_mesh"),
    ]
    for points, triangles, charts, more, code in cases:
        with pytest.raises(EngineError) as caught:
            pack(points, triangles, charts, options(), Context(1), **more)
        assert caught.value.code == code
