"""From mesh to reduced face features, with a tiny network in place of the published one."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from partuv_worker.features.partfield import prior as partfield_prior
from partuv_worker.features.partfield.network import PartFieldNetwork
from partuv_worker.features.partfield.prior import face_features, part_table, reduced_features
from partuv_worker.features.partfield.sampling import normalised_positions
from partuv_worker.features.reduce import unit_rows
from partuv_worker.partfield_settings import PartFieldSettings

Mesh = tuple[NDArray[np.float64], NDArray[np.int32]]
SETTINGS = PartFieldSettings(Path("unused"), points=3000, points_per_face=4)


def test_rows_are_unit_and_keep_the_distances(
    tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh]
) -> None:
    positions, faces = ball(16)
    with torch.inference_mode():
        reduced = reduced_features(tiny_network, positions, faces, SETTINGS)
        placed = normalised_positions(positions, SETTINGS.frame)
        table = part_table(tiny_network, placed, faces, SETTINGS)
        full = unit_rows(face_features(table, placed, faces, SETTINGS))
    assert reduced.dtype == np.float32
    assert reduced.shape[0] == len(faces)
    assert reduced.shape[1] <= full.shape[1]
    np.testing.assert_allclose(np.linalg.norm(reduced, axis=1), 1, atol=1e-5)
    np.testing.assert_allclose(reduced @ reduced.T, full @ full.T, atol=2e-3)


def test_chunks_do_not_change_a_bit(
    tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh], monkeypatch: pytest.MonkeyPatch
) -> None:
    mesh = ball(12)
    with torch.inference_mode():
        at_once = reduced_features(tiny_network, *mesh, SETTINGS)
        monkeypatch.setattr(partfield_prior, "POINTS_PER_CHUNK", 4 * 37)
        in_chunks = reduced_features(tiny_network, *mesh, SETTINGS)
    np.testing.assert_array_equal(at_once, in_chunks)


def test_the_result_is_held_to_its_size(
    tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh], monkeypatch: pytest.MonkeyPatch
) -> None:
    positions, faces = ball(12)
    monkeypatch.setattr(partfield_prior, "RESULT_BYTES", 4 * 3 * len(faces))
    with torch.inference_mode():
        rows = reduced_features(tiny_network, positions, faces, SETTINGS)
    assert rows.shape == (len(faces), 3)


def test_scale_and_place_of_the_mesh_do_not_matter(
    tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh]
) -> None:
    positions, faces = ball(12)
    with torch.inference_mode():
        here = reduced_features(tiny_network, positions, faces, SETTINGS)
        there = reduced_features(tiny_network, positions * 64 + 512, faces, SETTINGS)
    np.testing.assert_allclose(here @ here.T, there @ there.T, atol=1e-3)


def test_frames_differ(tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh]) -> None:
    positions, faces = ball(12)
    octant = PartFieldSettings(Path("unused"), points=3000, points_per_face=4, frame="partuv")
    with torch.inference_mode():
        a = reduced_features(tiny_network, positions, faces, SETTINGS)
        b = reduced_features(tiny_network, positions, faces, octant)
    assert np.abs(a @ a.T - b @ b.T).max() > 0.01


def test_half_precision_is_close(
    tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh]
) -> None:
    positions, faces = ball(12)
    half = PartFieldSettings(Path("unused"), points=3000, points_per_face=4, precision="half")
    placed = normalised_positions(positions, "partfield")
    with torch.inference_mode():
        exact = part_table(tiny_network, placed, faces, SETTINGS)
        rounded = part_table(tiny_network, placed, faces, half)
    assert rounded.dtype == torch.float32
    error = ((exact - rounded).square().mean() / exact.square().mean()).sqrt()
    assert 1e-6 < error < 0.05


def test_progress_rises_to_the_end_and_stops_the_work(
    tiny_network: PartFieldNetwork, ball: Callable[[int], Mesh]
) -> None:
    seen: list[float] = []

    class StopError(Exception):
        pass

    def stop(done: float) -> None:
        if done > 0.3:
            raise StopError

    with torch.inference_mode():
        reduced_features(tiny_network, *ball(12), SETTINGS, seen.append)
        with pytest.raises(StopError):
            reduced_features(tiny_network, *ball(12), SETTINGS, stop)
        before = len(seen)
        reduced_features(tiny_network, *ball(12), SETTINGS)
    assert seen == sorted(seen)
    assert seen[-1] == 1
    assert len(seen) > 4
    assert len(seen) == before  # nothing of an earlier call still listens


def test_degenerate_meshes_get_finite_rows(tiny_network: PartFieldNetwork) -> None:
    point = np.zeros((3, 3)), np.array([[0, 1, 2]], np.int32)
    sliver = np.eye(3), np.array([[0, 1, 1], [0, 1, 2]], np.int32)
    with torch.inference_mode():
        for positions, faces in (point, sliver):
            rows = reduced_features(tiny_network, positions, faces, SETTINGS)
            assert len(rows) == len(faces)
            assert np.isfinite(rows).all()
