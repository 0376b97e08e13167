"""Which prior runs, and what the caller is told about it."""

import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from partuv_contract.errors import CheckpointError, FeaturesError
from partuv_worker.features import (
    FaceFeatures,
    GeometricTree,
    PartFieldSettings,
    Priors,
)
from partuv_worker.features.partfield.sampling import face_areas

Mesh = tuple[NDArray[np.float64], NDArray[np.int32]]


def test_geometric_leaves_the_tree_to_the_engine(ball: Callable[[int], Mesh]) -> None:
    chosen = Priors().choose("geometric")
    result = chosen.prior.parts(*ball(8))
    assert chosen.notes == ()
    assert isinstance(result.grounds, GeometricTree)
    assert (result.name, result.seconds) == ("geometric", 0.0)


def test_normals_are_the_features(ball: Callable[[int], Mesh]) -> None:
    positions, faces = ball(8)
    result = Priors().choose("normals").prior.parts(positions, faces)
    assert isinstance(result.grounds, FaceFeatures)
    normals = result.grounds.values
    assert normals.shape == (len(faces), 3)
    lengths = np.linalg.norm(normals, axis=1)
    assert np.all(np.isclose(lengths, 1, atol=1e-6) | (lengths == 0))
    corners = positions[faces]
    # The slivers at the poles have edges of 1e-16, whose direction is rounding.
    sound = face_areas(positions, faces) > 1e-9
    corners, normals = corners[sound], normals[sound]
    for side in (corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]):
        assert np.abs(np.einsum("fd,fd->f", normals, side)).max() < 1e-5
    outward = corners.mean(axis=1) - positions.mean(axis=0)
    towards = np.einsum("fd,fd->f", normals, outward)
    assert (towards > 0).all() or (towards < 0).all()


def test_auto_without_a_checkpoint_says_so() -> None:
    chosen = Priors().choose("auto")
    assert chosen.prior.name == "geometric"
    assert "no PartField checkpoint is configured" in chosen.notes[0]


@pytest.mark.skipif(not find_spec("torch"), reason="torch is not installed: no network to test")
def test_auto_with_an_unreadable_checkpoint_says_why(tmp_path: Path) -> None:
    bad = tmp_path / "bad.ckpt"
    bad.write_bytes(b"PK\x03\x04 cut short")
    chosen = Priors(PartFieldSettings(bad)).choose("auto")
    assert chosen.prior.name == "geometric"
    assert "bad.ckpt" in chosen.notes[0]


def test_partfield_by_name_never_falls_back() -> None:
    with pytest.raises(FeaturesError, match="no PartField checkpoint"):
        Priors().choose("partfield")


@pytest.mark.skipif(not find_spec("torch"), reason="torch is not installed: no network to test")
def test_partfield_needs_its_file(tmp_path: Path) -> None:
    with pytest.raises(CheckpointError, match=r"absent\.ckpt: can't be read"):
        Priors(PartFieldSettings(tmp_path / "absent.ckpt")).choose("partfield")


def test_torch_is_imported_for_partfield_only() -> None:
    code = (
        "import sys; from partuv_worker.features import Priors;"
        "Priors().choose('auto'); Priors().choose('normals');"
        "import partuv_worker.features.cli; print('torch' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
