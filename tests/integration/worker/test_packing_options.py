"""Packing options through the pipeline: tiles, groups and what the file and the report say."""

from pathlib import Path

import numpy as np
import pytest
from partuv_contract.errors import OptionError
from partuv_contract.options import UnwrapOptions
from partuv_worker import samples
from partuv_worker.pipeline import UnwrapResult, unwrap_glb

from tests.support.glb_builder import GlbBuilder
from tests.support.glb_parse import ParsedGlb

ROBOT = Path(samples.__file__).with_name("robot.glb").read_bytes()


def unwrapped(**options: object) -> UnwrapResult:
    return unwrap_glb(ROBOT, UnwrapOptions.parse(options), threads=2)


def tile_of_uv(result: UnwrapResult) -> np.ndarray:
    """The UDIM tile of each triangle, from the UVs in the file (V down)."""
    parsed = ParsedGlb(result.glb)
    primitives = [piece.primitive for piece in result.soup.pieces]
    corners = np.concatenate(
        [parsed.corners("TEXCOORD_0", one.mesh, one.number) for one in primitives]
    ).astype(np.float64)
    column = np.floor(corners[..., 0]).astype(int)
    row = np.floor(1 - corners[..., 1]).astype(int)
    assert (column == column[:, :1]).all()
    assert (row == row[:, :1]).all()
    return column[:, 0] + 10 * row[:, 0]


def test_tiles_lie_side_by_side_in_the_file() -> None:
    result = unwrapped(tiles=3)
    numbers = [tile.udim for tile in result.report.tiles]
    assert numbers == [1001, 1002, 1003]
    assert result.report.tile_count == 3
    np.testing.assert_array_equal(tile_of_uv(result), result.atlas.tile)
    extras = ParsedGlb(result.glb).json["asset"]["extras"]["partuv"]["tiles"]
    assert extras == {"layout": "udim", "numbers": numbers}
    for tile in result.report.tiles:
        assert tile.gutter_texels is None or tile.gutter_texels >= 4
        assert 0 < tile.packing_efficiency <= 1
    assert sum(tile.charts for tile in result.report.tiles) == result.report.chart_count


def test_a_tile_per_part() -> None:
    result = unwrapped(tiles="per_part", parts=12)
    assert result.report.tile_count == len({chart.part for chart in result.report.charts}) > 5
    np.testing.assert_array_equal(tile_of_uv(result), result.atlas.tile)
    for chart in result.report.charts:
        same = {other.tile for other in result.report.charts if other.part == chart.part}
        assert same == {chart.tile}


def test_one_tile_says_nothing_in_the_file() -> None:
    result = unwrapped()
    assert "extras" not in ParsedGlb(result.glb).json["asset"]
    (tile,) = result.report.tiles
    assert tile.udim == 1001
    assert tile.packing_efficiency == pytest.approx(result.report.packing_efficiency)
    assert tile.covered_texels == pytest.approx(
        result.report.packing_efficiency * 1020**2, rel=0.01
    )


def density(result: UnwrapResult) -> float:
    """Texels per unit of length, from the areas."""
    triangles = result.soup.positions[result.soup.faces]
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    uv = result.atlas.corner_uv.astype(np.float64) * 1024
    u, v = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    texels = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum()
    return float(np.sqrt(texels / np.linalg.norm(cross, axis=1).sum()))


def test_texel_density_is_per_unit_of_the_model() -> None:
    as_fits = density(unwrapped())
    result = unwrapped(texel_density=1.05 * as_fits)
    assert result.report.tile_count > 1
    assert density(result) == pytest.approx(1.05 * as_fits, rel=0.02)


def test_strict_groups_lie_in_boxes_of_their_own() -> None:
    result = unwrapped(group_by_part="strict", parts=6)
    chart_part = np.array([chart.part for chart in result.report.charts])
    part = chart_part[result.atlas.chart]
    boxes = []
    for number in np.unique(part):
        corners = result.atlas.corner_uv[part == number].reshape(-1, 2)
        boxes.append((corners.min(axis=0), corners.max(axis=0)))
    for one, (low, high) in enumerate(boxes):
        for other_low, other_high in boxes[:one]:
            gap = np.maximum(other_low - high, low - other_high).max()
            assert gap * 1024 >= 4


def test_an_impossible_density_is_refused_in_clear_words() -> None:
    with pytest.raises(OptionError, match=r"texel_density.*larger than a tile"):
        unwrapped(texel_density=1e6)


def shards(count: int) -> bytes:
    """Triangles that do not touch, each a chart."""
    places = np.stack([3.0 * np.arange(count), np.zeros(count), np.zeros(count)], axis=1)
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]]) + places[:, None]
    builder = GlbBuilder()
    positions = builder.positions(corners.reshape(-1, 3).astype("f"))
    builder.node(mesh=builder.mesh({"attributes": {"POSITION": positions}}))
    return builder.build()


def test_a_gutter_that_no_packing_has_room_for_is_told() -> None:
    """Not even points at 4 texels from each other fit 16 x 16 texels 40 times."""
    options = UnwrapOptions.parse({"resolution": 16})
    report = unwrap_glb(shards(40), options).report
    (tile,) = report.tiles
    assert tile.gutter_texels is not None
    assert 0 < tile.gutter_texels < 4
    (note,) = [note for note in report.notes if "texels apart" in note]
    assert (
        f"tile 1001: its 40 charts lie {tile.gutter_texels:.3g} texels apart instead of 4" in note
    )
    assert not unwrap_glb(shards(6), options).report.notes
