"""Parts through the pipeline and from the command line."""

from pathlib import Path

import numpy as np
import pytest
from partuv_contract.options import UnwrapOptions
from partuv_worker import samples
from partuv_worker.pipeline import UnwrapResult, unwrap_glb

from tests.support.glb_parse import ParsedGlb

ROBOT = Path(samples.__file__).with_name("robot.glb")


@pytest.fixture(scope="module", params=["search", "auto", 7])
def unwrapped(request: pytest.FixtureRequest) -> UnwrapResult:
    return unwrap_glb(ROBOT.read_bytes(), UnwrapOptions(parts=request.param))


def test_the_report_lists_the_parts(unwrapped: UnwrapResult) -> None:
    report, atlas = unwrapped.report, unwrapped.atlas
    assert [part.id for part in report.parts] == list(range(report.part_count))
    assert sum(part.faces for part in report.parts) == report.faces
    assert sum(part.area_share for part in report.parts) == pytest.approx(1)
    for part in report.parts:
        of_part = atlas.part == part.id
        assert part.faces == of_part.sum() > 0
        assert part.charts == len(set(atlas.chart[of_part]))
    assert {chart.part for chart in report.charts} <= {part.id for part in report.parts}


def test_parts_of_the_search_consist_of_charts_and_others_need_not() -> None:
    data = ROBOT.read_bytes()
    search = unwrap_glb(data, UnwrapOptions()).report
    assert sum(part.charts for part in search.parts) == search.chart_count
    seven = unwrap_glb(data, UnwrapOptions(parts=7)).report
    assert seven.part_count == 7
    assert sum(part.charts for part in seven.parts) >= seven.chart_count == search.chart_count


def test_with_an_atlas_per_mesh_each_mesh_has_parts_of_its_own() -> None:
    result = unwrap_glb(ROBOT.read_bytes(), UnwrapOptions(parts=2, scope="mesh"))
    pieces = result.soup.pieces
    firsts = [piece.first_face for piece in pieces]
    of_pieces = [set(part.tolist()) for part in np.split(result.atlas.part, firsts[1:])]
    assert [len(parts) for parts in of_pieces] == [2] * len(pieces)
    assert len(set.union(*of_pieces)) == result.report.part_count == 2 * len(pieces)


def test_the_coloured_surface_has_the_same_triangles_and_tells_the_part_of_each(
    unwrapped: UnwrapResult,
) -> None:
    coloured, soup = ParsedGlb(unwrapped.parts_glb()), unwrapped.soup
    expected = soup.positions[soup.faces].astype(np.float32)
    np.testing.assert_array_equal(coloured.corners("POSITION"), expected)
    part = coloured.corners("_PART")[..., 0]
    np.testing.assert_array_equal(part, np.repeat(unwrapped.atlas.part[:, None], 3, axis=1))
    colors = coloured.corners("COLOR_0")
    assert len(np.unique(colors.reshape(-1, 4), axis=0)) == unwrapped.report.part_count
    assert (colors == colors[:, :1]).all()
    assert (colors[..., 3] == 255).all()
