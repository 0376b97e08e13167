"""The compose files give the worker its checkpoint; their images have what reads it."""

import os
from pathlib import Path
from typing import Any

import pytest
import yaml
from partuv_worker.settings import WorkerSettings

DOCKER = Path(__file__).resolve().parents[3] / "docker"


def worker_of(*names: str) -> dict[str, Any]:
    """The worker of several compose files, the later ones over the earlier ones."""
    merged: dict[str, Any] = {"args": {}, "environment": {}, "volumes": []}
    for name in names:
        worker = yaml.safe_load((DOCKER / name).read_text())["services"]["worker"]
        merged["args"] |= worker["build"].get("args", {})
        merged["environment"] |= worker["environment"]
        merged["volumes"] += worker.get("volumes", [])
    return merged


@pytest.mark.parametrize(
    ("overlays", "device"),
    [
        (("compose.partfield.yaml",), "cpu"),
        (("compose.partfield.yaml", "compose.gpu.yaml"), "cuda"),
    ],
)
def test_the_worker_gets_the_weights_and_what_reads_them(
    overlays: tuple[str, ...], device: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    worker = worker_of("compose.yaml", *overlays)
    (mount,) = worker["volumes"]
    assert mount["read_only"] is True
    assert "partfield" in worker["args"]["EXTRAS"].split(",")
    for name in [name for name in os.environ if name.startswith("PARTUV_")]:
        monkeypatch.delenv(name)
    for name, value in worker["environment"].items():
        monkeypatch.setenv(name, value)
    settings = WorkerSettings().partfield
    assert settings is not None
    assert str(settings.checkpoint) == mount["target"]
    assert settings.device == device
