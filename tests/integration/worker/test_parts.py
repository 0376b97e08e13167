"""Parts through the pipeline and from the command line."""

import json
from pathlib import Path

import numpy as np
import pytest
from partuv_contract.errors import CancelledError
from partuv_contract.options import UnwrapOptions
from partuv_worker import samples
from partuv_worker.cli import parts, unwrap
from partuv_worker.parts.segment import Segment
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


def run(*arguments: object) -> int:
    command = {"unwrap": unwrap.command, "parts": parts.command}[str(arguments[0])]
    return command([str(argument) for argument in arguments[1:]])


def test_unwrap_writes_the_coloured_surface_beside_the_atlas(tmp_path: Path) -> None:
    out, coloured, report = (tmp_path / name for name in ("out.glb", "parts.glb", "report.json"))
    files = ("-o", out, "--parts", coloured, "--report", report)
    assert run("unwrap", ROBOT, *files, "--parts", "3", "-q") == 0
    assert json.loads(report.read_text())["part_count"] == 3
    assert set(ParsedGlb(coloured.read_bytes()).corners("_PART").ravel()) == {0, 1, 2}


def test_unwrap_refuses_what_is_neither_a_word_nor_a_number_nor_a_glb(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("unwrap", ROBOT, "-o", tmp_path / "out.glb", "--parts", "atuo") == 2
    assert "not atuo" in capsys.readouterr().err
    assert run("unwrap", ROBOT, "-o", tmp_path / "out.glb", "--parts", "0") == 2
    assert "parts" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_coloured_files_of_a_folder_are_not_unwrapped_in_turn(tmp_path: Path) -> None:
    folder = tmp_path / "in"
    folder.mkdir()
    (folder / "robot.glb").write_bytes(ROBOT.read_bytes())
    for _ in range(2):
        arguments = ("-o", tmp_path / "out", "--parts", folder / "parts", "--flattening", "lscm")
        assert run("unwrap", folder, *arguments, "-q") == 0
    assert [path.name for path in (folder / "parts").iterdir()] == ["robot.glb"]
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["robot.glb"]


def test_the_parts_command_tells_what_an_unwrap_would(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    coloured = tmp_path / "parts.glb"
    assert run("parts", ROBOT, "-o", coloured, "--json") == 0
    told = capsys.readouterr()
    report = json.loads(told.out)
    atlas = unwrap_glb(ROBOT.read_bytes(), UnwrapOptions(parts="auto")).atlas
    assert report["part_of_face"] == atlas.part.tolist()
    assert report["part_count"] == atlas.part_count == len(report["parts"])
    assert f"{atlas.part_count} parts of 11,964 triangles" in told.err
    assert set(ParsedGlb(coloured.read_bytes()).corners("_PART").ravel()) == set(atlas.part)


def test_the_parts_command_takes_a_number_features_and_names(
    capsys: pytest.CaptureFixture[str],
) -> None:
    reports = []
    for arguments in (("--features", "normals"), ("--features", "auto"), ("--only", "Head")):
        assert run("parts", ROBOT, "--parts", "20", "--json", "-q", *arguments) == 0
        told = capsys.readouterr()
        assert told.err == ""
        reports.append(json.loads(told.out))
    normals, auto, head = reports
    assert {report["part_count"] for report in reports} == {20}
    assert normals["features"]["prior"] == "normals"
    assert normals["part_of_face"] != auto["part_of_face"]
    assert "no PartField checkpoint" in auto["notes"][0]
    assert head["faces"] < auto["faces"]


def test_the_parts_command_refuses_in_the_same_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = tmp_path / "broken.glb"
    broken.write_bytes(ROBOT.read_bytes()[:-1])
    assert run("parts", broken) == 3
    assert "[malformed_glb]" in capsys.readouterr().err
    assert run("parts", tmp_path / "none.glb") == 4
    assert run("parts", ROBOT, "--parts", "search") == 2
    assert run("parts", ROBOT, "--parts", "-1") == 2
    assert run("parts", ROBOT, "--features", "partfield") == 3


def test_a_segmentation_can_be_stopped() -> None:
    segment = Segment("auto")
    segment.cancel()
    with pytest.raises(CancelledError):
        segment.run(ROBOT.read_bytes())
