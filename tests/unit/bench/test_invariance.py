import numpy as np
import pytest

from bench.compare.meshes import MeshFile
from bench.invariance import VARIANTS, largest_change, print_table
from tests.support.glb_builder import grid, tetrahedron


def side_lengths(positions: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Of each face in ascending order, faces in ascending order."""
    corners = positions[faces]
    lengths = np.sort(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2), axis=1)
    return lengths[np.lexsort(np.round(lengths.T, 9))]


def winding(positions: np.ndarray, faces: np.ndarray) -> float:
    corners = positions[faces]
    return float(np.linalg.det(corners).sum())


@pytest.mark.parametrize("name", VARIANTS)
def test_a_variant_is_the_same_mesh_up_to_its_size(name):
    points, faces = grid(5, 4)
    points = points + np.random.default_rng(5).normal(0, 0.2, points.shape)
    positions, variant_faces = VARIANTS[name](points, faces)
    expected, lengths = side_lengths(points, faces), side_lengths(positions, variant_faces)
    scale = {"x 1e-4": 1e-4, "x 1e4": 1e4}.get(name, 1.0)
    np.testing.assert_allclose(lengths, scale * expected, rtol=1e-9)
    assert not np.array_equal(positions[variant_faces], points[faces])
    if name != "moved":
        assert winding(positions, variant_faces) == pytest.approx(scale**3 * winding(points, faces))


def test_the_change_is_relative_to_the_plain_run():
    assert largest_change([10, 9, 12, 10]) == pytest.approx(0.2)


def test_a_row_per_mesh_and_a_summary(tmp_path, capsys):
    path = tmp_path / "tetrahedron.glb"
    path.write_bytes(tetrahedron().build())
    print_table([MeshFile(path.stem, path)], within=0.1)
    rows = capsys.readouterr().out.splitlines()
    cells = [cell.strip() for cell in rows[2].strip("|").split("|")]
    assert cells[0] == "tetrahedron"
    counts = [int(cell) for cell in cells[2:-1]]
    assert len(counts) == 1 + len(VARIANTS)
    assert cells[-1] == f"{100 * largest_change(counts):.1f} %"
    assert rows[-1].startswith(("0 of 1", "1 of 1"))
