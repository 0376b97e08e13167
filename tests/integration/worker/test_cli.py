"""`partuv unwrap` as a person runs it."""

import json
import os
import signal
import threading
import time
from pathlib import Path

import partuv_worker.samples
import pytest
from partuv_contract.commands import main

from tests.support.glb_builder import tetrahedron
from tests.support.glb_parse import ParsedGlb
from tests.support.patches import patch_builder, patches

ROBOT = Path(partuv_worker.samples.__file__).with_name("robot.glb")


@pytest.fixture
def tetra(tmp_path):
    path = tmp_path / "tetra.glb"
    path.write_bytes(tetrahedron().build())
    return path


def test_unwraps_a_file_with_report_and_preview(tetra, tmp_path, capsys):
    out, report, preview = (tmp_path / name for name in ("out.glb", "r/report.json", "atlas.png"))
    arguments = ["unwrap", tetra, "-o", out, "--report", report, "--preview", preview]
    assert main([str(argument) for argument in arguments]) == 0
    assert "TEXCOORD_0" in ParsedGlb(out.read_bytes()).primitive()["attributes"]
    assert json.loads(report.read_text())["faces"] == 4
    assert preview.read_bytes().startswith(b"\x89PNG")
    told = capsys.readouterr().err
    for word in ("charts", "area distortion", "seam length", "packing", "seconds", "written"):
        assert word in told


def test_packs_the_charts_of_a_file_anew(tmp_path, capsys):
    source, out = tmp_path / "patches.glb", tmp_path / "out.glb"
    source.write_bytes(patch_builder(patches(2, 5)).build())
    assert main(["unwrap", str(source), "-o", str(out), "--mode", "repack"]) == 0
    assert "TEXCOORD_1" in ParsedGlb(out.read_bytes()).primitive()["attributes"]
    told = capsys.readouterr().err
    assert "charts           5" in told
    assert "part tree" not in told


def test_quiet_says_nothing(tetra, tmp_path, capsys):
    assert main(["unwrap", "-q", str(tetra), "-o", str(tmp_path / "out.glb")]) == 0
    assert capsys.readouterr() == ("", "")


def test_a_refused_input_is_explained_and_nothing_is_written(tetra, tmp_path, capsys):
    tetra.write_bytes(tetra.read_bytes()[:-4])
    assert main(["unwrap", str(tetra), "-o", str(tmp_path / "out.glb")]) == 3
    told = capsys.readouterr().err
    assert "the header declares" in told
    assert "[malformed_glb]" in told
    assert not (tmp_path / "out.glb").exists()


def test_wrong_options_and_missing_files_have_codes_of_their_own(tetra, tmp_path, capsys):
    out = str(tmp_path / "out.glb")
    assert main(["unwrap", str(tetra), "-o", out, "--threshold", "0.5"]) == 2
    assert "max_area_distortion" in capsys.readouterr().err
    assert main(["unwrap", str(tmp_path / "none.glb"), "-o", out]) == 4
    assert "No such file" in capsys.readouterr().err
    tetra.with_name("file").touch()
    assert main(["unwrap", str(tetra), "-o", str(tmp_path / "file" / "out.glb")]) == 4


def test_a_folder_goes_on_after_failures_and_names_them(tmp_path, capsys):
    folder = tmp_path / "in"
    (folder / "deep").mkdir(parents=True)
    (folder / "a.glb").write_bytes(b"not a GLB")
    (folder / "deep" / "b.glb").write_bytes(tetrahedron().build())
    out = tmp_path / "out"
    assert main(["unwrap", str(folder), "-o", str(out), "--preview", str(tmp_path / "p")]) == 6
    assert (out / "deep" / "b.glb").is_file()
    assert (tmp_path / "p" / "deep" / "b.png").is_file()
    told = capsys.readouterr().err
    assert "1 of 2 files unwrapped" in told
    assert "a.glb" in told.partition("these failed")[2]


def test_an_empty_folder_is_an_error(tmp_path):
    (tmp_path / "in").mkdir()
    assert main(["unwrap", str(tmp_path / "in"), "-o", str(tmp_path / "out")]) == 4


def test_interrupting_stops_the_engine_and_leaves_no_file(tmp_path, capsys):
    before = signal.getsignal(signal.SIGINT)

    def interrupt():
        while signal.getsignal(signal.SIGINT) is before:  # until the engine is at work
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt).start()
    out = tmp_path / "out.glb"
    assert main(["unwrap", str(ROBOT), "-o", str(out), "--threshold", "1.02"]) == 130
    assert "cancelled" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
    assert signal.getsignal(signal.SIGINT) is before
