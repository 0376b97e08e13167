from dataclasses import replace

import pytest

from bench.compare.judge import Figures
from bench.compare.results import Result, Results
from bench.compare.summary import by_tool, finished, mean_ratio, sum_ratio
from bench.compare.tables import compared_table, meshes_table, steps_table

FIGURES = Figures(4, 1, 1.2, 1.1, 0.96, 0.95, 3.0, 0, 0, True, 4.0, 0.6)
OURS = Result("cow", "d1", 100, "ours", "1", "ok", 60, 2.0, 3.0, 50, FIGURES)


def other(mesh: str, charts: int, seconds: float, **changed: object) -> Result:
    figures = replace(FIGURES, charts=charts)
    return replace(OURS, mesh=mesh, tool="other", seconds=seconds, figures=figures, **changed)


def rows(table: str) -> dict[str, list[str]]:
    lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()]
    return {line[0]: line[1:] for line in lines}


RESULTS = [
    OURS,
    replace(OURS, mesh="pig", seconds=6.0),
    other("cow", 8, 4.0),
    other("pig", 32, 12.0),
    replace(OURS, mesh="elk", tool="other", status="timeout", seconds=None, figures=None),
]


def test_ratios_are_over_the_meshes_that_both_finished():
    tools = by_tool(RESULTS)
    runs, ours = finished(tools["other"]), finished(tools["ours"])
    assert mean_ratio(runs, ours, lambda run: run.figures.charts) == pytest.approx(4)  # of 2 and 8
    assert sum_ratio(runs, ours, lambda run: run.seconds) == pytest.approx(2)
    assert mean_ratio({}, ours, lambda run: run.figures.charts) is None


def test_the_tables_tell_what_finished_and_what_did_not():
    tools = by_tool(RESULTS)
    tools["gone"] = {"cow": replace(OURS, tool="gone", status="unavailable", figures=None)}
    compared = rows(compared_table(["ours", "other", "gone"], tools, "ours"))
    assert compared["ours"][:3] == ["2 of 2", "8", "1.00"]
    assert compared["other"][:3] == ["2 of 3", "40", "4.00"]
    assert compared["gone"][0] == "not available"
    assert len(set(map(len, compared.values()))) == 1
    meshes = rows(meshes_table(["ours", "other"], tools))
    assert meshes["pig"] == ["100", "4 (6.0 s)", "32 (12.0 s)"]
    assert meshes["elk"] == ["100", "", "time-out"]
    assert rows(steps_table(["ours", "other"], tools, "ours"))["other"][-2:] == ["2.00", "1.00"]


def test_slivers_and_roughness_are_of_the_runs_that_were_asked_for_them():
    measured = [
        replace(OURS, mesh=mesh, figures=replace(FIGURES, slivers=thin, seam_roughness=rough))
        for mesh, thin, rough in (("cow", 2, 1.1), ("pig", 3, None), ("elk", 0, 1.3))
    ]
    tools = by_tool([*measured, other("cow", 8, 4.0)])
    compared = rows(compared_table(["ours", "other"], tools, "ours"))
    assert compared["ours"][4:6] == ["1.20", "5"]
    assert compared["other"][4:6] == ["", ""]


def test_results_are_taken_up_again(tmp_path):
    path = tmp_path / "set.jsonl"
    written = Results(path)
    for result in RESULTS:
        written.add(result)
    written.add(other("cow", 7, 3.0, version="2"))
    read = Results(path)
    assert sorted(read, key=repr) == sorted(written, key=repr)
    assert by_tool(read)["other"]["cow"].figures == replace(FIGURES, charts=7)
    assert read.is_done("cow", "d1", "other", "2", 60)
    assert not read.is_done("cow", "d1", "other", "1", 60), "another version"
    assert not read.is_done("cow", "d2", "other", "2", 60), "another mesh"
    assert read.is_done("elk", "d1", "other", "1", 60)
    assert not read.is_done("elk", "d1", "other", "1", 120), "a time-out, and now there is more"
