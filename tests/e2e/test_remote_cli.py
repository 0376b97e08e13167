"""`partuv unwrap --server`: what a local run does, done by the service."""

import json
import os
import signal
import threading
import time
from pathlib import Path

import httpx
import pytest
from partuv_contract.commands import main

from tests.support.follow import look
from tests.support.glb_builder import tetrahedron
from tests.support.glb_parse import ParsedGlb
from tests.support.meshes import quick, slow
from tests.support.service import Gateway, free_port, until


@pytest.fixture
def source(tmp_path: Path) -> Path:
    path = tmp_path / "in.glb"
    path.write_bytes(quick(401))
    return path


def run(*arguments: object) -> int:
    return main(["unwrap", *map(str, arguments)])


def test_the_result_is_that_of_a_local_run(
    gateway: Gateway, source: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = ("h.glb", "t.glb", "r.json", "p.png", "p.glb")
    here, there, report, preview, parts = (tmp_path / name for name in names)
    flags = ["--gutter-texels", 6, "--parts", "auto"]
    files = ["--report", report, "--preview", preview, "--parts", parts]
    assert run(source, "-o", there, "--server", gateway.url, *flags, *files) == 0
    assert "charts" in capsys.readouterr().err
    assert "TEXCOORD_0" in ParsedGlb(there.read_bytes()).primitive()["attributes"]
    assert json.loads(report.read_text())["faces"] > 100
    assert preview.read_bytes().startswith(b"\x89PNG")
    assert "COLOR_0" in ParsedGlb(parts.read_bytes()).primitive()["attributes"]
    assert run(source, "-o", here, *flags) == 0
    assert here.read_bytes() == there.read_bytes()


def test_a_refusal_says_what_a_local_run_says(
    gateway: Gateway, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    broken = tetrahedron()
    broken.json["accessors"][0]["count"] = 1000
    source, target = tmp_path / "broken.glb", tmp_path / "out.glb"
    source.write_bytes(broken.build())
    told = []
    for where in ([], ["--server", gateway.url]):
        assert run("-q", source, "-o", target, *where) == 3
        told.append(capsys.readouterr().err)
    assert told[0] == told[1]
    assert "malformed_glb" in told[0]
    assert not target.exists()


def test_nobody_at_the_address(
    source: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture
) -> None:
    monkeypatch.setattr(time, "sleep", lambda _: None)  # between the tries
    url = f"http://127.0.0.1:{free_port()}"
    assert run("-q", source, "-o", tmp_path / "out.glb", "--server", url) == 7
    assert url in capsys.readouterr().err


def test_interrupting_cancels_the_job_there(
    gateway: Gateway, http: httpx.Client, tmp_path: Path
) -> None:
    source, target = tmp_path / "slow.glb", tmp_path / "out.glb"
    source.write_bytes(slow(402))

    def interrupt() -> None:
        until(lambda: http.get("/readyz").json()["running"], 60.0)
        os.kill(os.getpid(), signal.SIGINT)

    other = threading.Thread(target=interrupt)
    other.start()
    before = _submitted(gateway)
    assert run("-q", source, "-o", target, "--server", gateway.url) == 130
    other.join()
    assert not target.exists()
    (job_id,) = _submitted(gateway) - before
    until(lambda: look(http, job_id)["status"] == "canceled")


def _submitted(gateway: Gateway) -> set[str]:
    lines = [json.loads(line) for line in gateway.log.read_text().splitlines()]
    return {line["job_id"] for line in lines if "job_id" in line}
