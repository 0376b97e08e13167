"""The bench through its real parts: our own tools, in processes of their own."""

from dataclasses import replace
from pathlib import Path

import pytest

from bench.compare import running
from bench.compare.environments import Environments, Unavailable
from bench.compare.measuring import measure_all
from bench.compare.meshes import MeshFile
from bench.compare.results import Results
from bench.compare.shapes import gear
from bench.compare.summary import by_tool
from bench.compare.tools import ABLATIONS, COMPARED, OURS, Tool, chosen_tools

UNMERGED = Tool(
    "unmerged",
    "ablation",
    arguments=('{"ablation": {"fixed_parts": 20, "final_merge": false}, "tree": "normals"}',),
)


@pytest.fixture
def mesh(tmp_path) -> MeshFile:
    path = tmp_path / "gear.glb"
    path.write_bytes(gear())
    return MeshFile("gear", path)


def measure(mesh: MeshFile, tools: list[Tool], folder: Path, limit_s: float = 60) -> Results:
    results = Results(folder / "results.jsonl")
    environments = Environments(folder / "environments")
    measure_all([mesh], tools, results, environments, folder / "scratch", None, limit_s)
    return results


def test_our_tools_are_measured_once(mesh, tmp_path, capsys):
    first = by_tool(measure(mesh, [OURS, UNMERGED], tmp_path))
    for tool in (OURS, UNMERGED):
        result = first[tool.name]["gear"]
        assert result.status == "ok", result.message
        assert result.figures.flipped_faces == result.figures.overlapping_pairs == 0
        assert result.figures.area_distortion_worst <= 1.25
    charts = {name: results["gear"].figures.charts for name, results in first.items()}
    assert charts[UNMERGED.name] > charts[OURS.name]
    assert f"[1/1] gear, {UNMERGED.name}" in capsys.readouterr().out
    measure(mesh, [OURS, UNMERGED], tmp_path)
    assert not capsys.readouterr().out, "measured again"


def test_tools_are_chosen_by_name_or_by_what_names_contain():
    assert chosen_tools([OURS.name]) == [OURS]
    chosen = [tool.name for tool in chosen_tools(["service,", "no Merge"])]
    assert OURS.name not in chosen
    assert {"PartUV service, fast", "PartUV service, best", "no Merge"} <= set(chosen)
    assert chosen_tools([""]) == [*COMPARED, *ABLATIONS]


def test_another_way_to_use_a_tool_is_another_version():
    assert replace(OURS, arguments=('{"profile": "conformal"}',)).version != OURS.version
    assert replace(OURS, adapter="ablation").version != OURS.version
    assert replace(OURS, adapter="ablation").packages == OURS.packages


def test_a_run_ends_at_its_limit(mesh, tmp_path, monkeypatch):
    monkeypatch.setattr(running, "_STARTING_S", 0.0)
    result = measure(mesh, [OURS], tmp_path, limit_s=0.01)
    assert [r.status for r in result] == ["timeout"]


def test_what_fails_says_why(mesh, tmp_path):
    broken = Tool("broken", "service", arguments=('{"resolution": 1}',))
    (result,) = measure(mesh, [broken], tmp_path)
    assert (result.status, result.figures) == ("failed", None)
    assert result.message


def test_what_cannot_be_installed_is_not_available(mesh, tmp_path, monkeypatch):
    def refuse(python: Path, *arguments: str) -> None:
        raise Unavailable("ERROR: no such thing")

    monkeypatch.setattr("bench.compare.environments._install", refuse)
    (result,) = measure(mesh, [Tool("gone", "xatlas_tool", ("gone==1",))], tmp_path)
    assert (result.status, result.message) == ("unavailable", "ERROR: no such thing")


def test_what_cannot_be_read_is_left_out(tmp_path, capsys):
    path = tmp_path / "broken.glb"
    path.write_bytes(b"no GLB")
    assert not list(measure(MeshFile("broken", path), [OURS], tmp_path))
    assert "broken: left out" in capsys.readouterr().out
