import sys

import numpy as np
import pytest
from partuv_worker.measure import areas_3d

from bench import growth
from bench.compare.shapes import gear


def edge_uses(faces: np.ndarray) -> np.ndarray:
    sides = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=2).reshape(-1, 2), axis=1)
    return np.unique(sides, axis=0, return_counts=True)[1]


def test_the_creature_stays_closed_and_on_its_surface_as_it_grows():
    sizes = []
    for positions, faces in growth.meshes_of(None, 70_000):
        sizes.append(len(faces))
        assert (edge_uses(faces) == 2).all()
        assert np.abs(growth.creature(positions)).max() < 1e-3
    assert sizes == [sizes[0], 4 * sizes[0], 16 * sizes[0]]
    assert 900_000 < 256 * sizes[0] < 1_050_000


def test_splitting_keeps_the_surface():
    positions, faces = growth.creature_mesh()
    finer_positions, finer = growth.split(positions, faces)
    total = areas_3d(finer_positions[finer]).sum()
    assert total == pytest.approx(areas_3d(positions[faces]).sum())


def test_the_exponent_of_a_power_law():
    faces = [1_000, 10_000, 50_000]
    assert growth.exponent(faces, [3e-6 * count**1.5 for count in faces]) == pytest.approx(1.5)


def test_sizes_in_processes_of_their_own(monkeypatch, capsys, tmp_path):
    path = tmp_path / "gear.glb"
    path.write_bytes(gear())
    monkeypatch.setattr(sys, "argv", ["growth", "--mesh", str(path), "--most", "4000"])
    growth.main()
    sizes, stages = capsys.readouterr().out.split("\n\n")
    counts = [line.split("|")[1].strip() for line in sizes.splitlines()[2:]]
    assert counts == ["768", "3,072"]
    assert "| search |" in stages


def test_a_size_that_takes_too_long_ends_the_run(monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["growth", "--limit-s", "0.01"])
    growth.main()
    output = capsys.readouterr()
    assert "no result after 0.01 s" in output.err
    assert len(output.out.splitlines()) == 2
