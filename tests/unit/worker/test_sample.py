from pathlib import Path

import numpy as np
import partuv_worker.samples
from partuv_worker.glb.scene import Scene
from partuv_worker.samples.robot import robot

SAMPLE = Path(partuv_worker.samples.__file__).with_name("robot.glb")


def test_the_shipped_sample_is_the_one_that_the_script_builds():
    scene = Scene(SAMPLE.read_bytes())
    parts = robot()
    assert len(scene.soup.pieces) == len(parts)
    assert len(scene.soup.faces) == sum(len(part.faces) for part in parts)
    built = np.concatenate([part.positions[part.faces] for part in parts])
    assert np.allclose(scene.soup.positions[scene.soup.faces], built, atol=1e-4)
    assert SAMPLE.stat().st_size < 300_000


def test_its_parts_are_closed_and_face_outwards():
    for part in robot():
        edges = np.concatenate([part.faces[:, [k, (k + 1) % 3]] for k in range(3)])
        assert set(map(tuple, edges)) == set(map(tuple, edges[:, ::-1])), part.name
        corners = part.positions[part.faces].astype(float)
        volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
        assert volume > 0, part.name
