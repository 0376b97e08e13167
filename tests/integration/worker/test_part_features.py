"""Part trees from features, from the command line and through the service."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from partuv_contract.options import UnwrapOptions
from partuv_worker import samples
from partuv_worker.cli.unwrap import command
from partuv_worker.features import Priors
from partuv_worker.pipeline import Unwrap, unwrap_glb

from tests.support.partfield import filled_state, write_lightning_file
from tests.support.service import Stack, until
from tests.support.uploads import GLB

ROBOT = Path(samples.__file__).parent / "robot.glb"


@pytest.fixture(scope="module")
def checkpoint(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Weights that mean nothing, in the published file's layout and size."""
    pytest.importorskip("torch", reason="torch is not installed: no network to test")
    from partuv_worker.features.partfield.network import expected_parameters

    path = tmp_path_factory.mktemp("weights") / "weights.ckpt"
    yield write_lightning_file(path, filled_state(expected_parameters()))
    path.unlink()


@pytest.fixture
def broken(tmp_path: Path) -> Path:
    path = tmp_path / "broken.ckpt"
    path.write_bytes(b"PK\x03\x04 and nothing behind it")
    return path


def unwrap(target: Path, *arguments: str) -> tuple[int, dict[str, Any]]:
    report = target.with_suffix(".json")
    code = command([str(ROBOT), "-o", str(target), "--report", str(report), "-q", *arguments])
    return code, json.loads(report.read_text()) if report.exists() else {}


def test_normals_make_another_tree() -> None:
    data = ROBOT.read_bytes()
    built_in = unwrap_glb(data, UnwrapOptions())
    normals = unwrap_glb(data, UnwrapOptions(features="normals"))
    assert built_in.report.features.prior == "geometric"
    assert normals.report.features.prior == "normals"
    assert normals.report.seconds["features"] == normals.report.features.seconds > 0
    assert not np.array_equal(built_in.atlas.part, normals.atlas.part)


def test_each_mesh_of_a_scene_gets_its_own_rows() -> None:
    data = ROBOT.read_bytes()
    whole = unwrap_glb(data, UnwrapOptions(features="normals", scope="mesh"))
    assert len(whole.atlas.part) == whole.report.faces


def test_auto_without_a_checkpoint_does_what_geometric_does_and_says_so() -> None:
    data = ROBOT.read_bytes()
    auto = unwrap_glb(data, UnwrapOptions(features="auto"))
    assert auto.report.features.prior == "geometric"
    assert auto.report.notes == [
        "features: auto used the geometric tree: no PartField checkpoint is configured"
    ]
    geometric = unwrap_glb(data, UnwrapOptions())
    assert geometric.report.notes == []
    np.testing.assert_array_equal(auto.atlas.corner_uv, geometric.atlas.corner_uv)


def test_auto_falls_back_visibly_on_the_command_line(
    tmp_path: Path, broken: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch", reason="torch is not installed: no network to test")
    report = tmp_path / "report.json"
    arguments = [str(ROBOT), "-o", str(tmp_path / "out.glb"), "--report", str(report)]
    assert command([*arguments, "--checkpoint", str(broken), "--flattening", "lscm"]) == 0
    told = " ".join(capsys.readouterr().err.split())
    assert "part tree geometric" in told
    assert "note features: auto used the geometric tree:" in told
    assert "damaged or cut short" in told
    (note,) = json.loads(report.read_text())["notes"]
    assert "broken.ckpt: damaged or cut short" in note


def test_a_bad_checkpoint_is_refused_before_any_work(
    tmp_path: Path, broken: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("torch", reason="torch is not installed: no network to test")
    arguments = ("--features", "partfield", "--checkpoint", str(broken))
    code, report = unwrap(tmp_path / "out.glb", *arguments)
    assert (code, report) == (3, {})
    assert "broken.ckpt: damaged or cut short" in capsys.readouterr().err
    assert not (tmp_path / "out.glb").exists()


def test_cancelling_stops_within_the_features(monkeypatch: pytest.MonkeyPatch) -> None:
    run = Unwrap(UnwrapOptions(features="normals"))
    choose = Priors.choose

    def cancelled_meanwhile(self: Priors, choice: Any) -> Any:
        run.cancel()
        return choose(self, choice)

    monkeypatch.setattr(Priors, "choose", cancelled_meanwhile)
    with pytest.raises(Exception, match="cancelled"):
        run.run(ROBOT.read_bytes())
    assert run.progress.stage == "part features"


def test_a_checkpoint_runs_from_the_command_line(tmp_path: Path, checkpoint: Path) -> None:
    arguments = ("--checkpoint", str(checkpoint), "--points", "5000", "--threads", "2")
    code, report = unwrap(tmp_path / "out.glb", *arguments)
    assert code == 0
    assert report["features"]["prior"] == "partfield"
    assert report["features"]["version"].startswith("sha256:")
    assert report["seconds"]["features"] == report["features"]["seconds"] > 0
    assert report["notes"] == []
    assert report["area_distortion_worst"] <= 1.25


def test_a_checkpoint_runs_through_the_service(checkpoint: Path, broken: Path) -> None:
    stack = Stack()
    try:
        gateway = stack.gateway()
        settings = {"partfield_points": "5000", "job_memory_bytes": str(4 * 2**30)}
        worker = stack.worker(partfield_checkpoint=str(checkpoint), **settings)
        with httpx.Client(base_url=gateway.url, timeout=60.0) as http:
            until(lambda: http.get("/readyz").json()["workers"], 120.0)
            build = http.get("/version").json()["workers"][0]
            job = _finished(http, features="auto")
            assert job["status"] == "succeeded"
            version = job["report"]["features"]["version"].removeprefix("sha256:")
            assert build.endswith(f"-{version[:12]}")  # other weights, other cached results
            worker.stop()

            worker = stack.worker(partfield_checkpoint=str(broken), **settings)
            until(lambda: "no learned part features: broken.ckpt" in worker.log.read_text(), 120.0)
            until(lambda: http.get("/version").json()["workers"] not in ([], [build]), 60.0)
            job = _finished(http, features="partfield")
            assert job["status"] == "failed"
            assert job["error"]["code"] == "bad_checkpoint"
            job = _finished(http, features="auto")
            assert job["report"]["features"]["prior"] == "geometric"
            assert "broken.ckpt" in job["report"]["notes"][0]
    finally:
        stack.close()


def _finished(http: httpx.Client, **options: str) -> dict[str, Any]:
    answer = http.post("/v1/unwrap", params=options, content=ROBOT.read_bytes(), headers=GLB)
    assert answer.status_code < 300, answer.text
    address = f"/v1/jobs/{answer.json()['id']}"
    ended = ("succeeded", "failed", "canceled")
    until(lambda: http.get(address).json()["status"] in ended, 300.0, 0.5)
    job: dict[str, Any] = http.get(address).json()
    return job
