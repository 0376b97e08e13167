import numpy as np
import pytest

from bench.compare.judge.charts import find_charts
from bench.compare.judge.slivers import count_slivers

TEXEL = 1 / 1024


def slivers(points: np.ndarray, faces: np.ndarray, group: np.ndarray) -> int:
    """Of a plane mesh in texels that is cut between groups of faces."""
    uv = points[faces][:, :, :2] * TEXEL + np.stack([0 * group, group], axis=1)[:, None] / 8
    return count_slivers(points, faces, uv, find_charts(points, faces, uv))


def rectangles(*boxes: tuple[float, float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Two faces for each box (low x, low y, high x, high y) in texels; corners are shared."""
    corners = np.array([[(a, b), (c, b), (c, d), (a, d)] for a, b, c, d in boxes], float)
    plane, number = np.unique(corners.reshape(-1, 2), axis=0, return_inverse=True)
    faces = number.reshape(-1, 4)[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3)
    return np.column_stack([plane, 0 * plane[:, 0]]), faces


@pytest.mark.parametrize(("width", "count"), [(1.95, 1), (2.05, 0)])
def test_a_strip_of_a_sheet_is_a_sliver_below_two_texels(width, count):
    sheet = rectangles((0, 0, 80, 40), (0, 40, 80, 40 + width))
    assert slivers(*sheet, np.array([0, 0, 1, 1])) == count


def test_one_wide_place_is_enough():
    # A strip half a texel wide and 60 long, with a square of 3 texels at its end.
    boxes = ((0, 0, 60, 40), (60, 0, 63, 40), (0, 40, 60, 40.5), (60, 40, 63, 40.5))
    points, faces = rectangles(*boxes, (60, 40.5, 63, 43))
    group = np.array([0, 0, 0, 0, 1, 1, 1, 1, 1, 1])
    assert slivers(points, faces, group) == 0
    assert slivers(points, faces[:8], group[:8]) == 1


def test_a_thin_component_has_no_slivers():
    points, faces = rectangles((0, 0, 80, 40), (0, 60, 40, 61), (40, 60, 80, 61))
    assert slivers(points, faces, np.array([0, 0, 1, 1, 1, 1])) == 0, "one chart"
    assert slivers(points, faces, np.array([0, 0, 1, 1, 2, 2])) == 0, "cut"


@pytest.mark.parametrize(("width", "count"), [(1.9, 0), (2.1, 2)])
def test_a_shell_is_as_thin_as_its_front(width, count):
    # Flat, the front in two strips of half its width.
    points, front = rectangles((0, 0, 80, width / 2), (0, width / 2, 80, width))
    points = np.concatenate([points, [[40, width / 2, 0]]])
    around = [0, 3, 4, 5, 2, 1]
    back = [[6, one, other] for one, other in zip(np.roll(around, -1), around, strict=True)]
    assert slivers(points, np.concatenate([front, back]), np.repeat([0, 1, 2], [2, 2, 6])) == count
    open_sheet = np.repeat([0, 1], 2)
    assert slivers(points, front, open_sheet) == count


def test_a_thin_fin_on_an_edge_of_three_faces_is_a_component():
    points, faces = rectangles((0, 0, 40, 40), (40, 0, 80, 40), (40, 0, 41, 40))
    middle = [np.flatnonzero((points[:, 0] == 40) & (points[:, 1] == y))[0] for y in (0, 40)]
    assert np.isin(middle, faces[:2]).all()
    assert slivers(points, faces, np.array([0, 0, 1, 1, 2, 2])) == 0


def test_a_face_wound_against_its_neighbours_is_a_component():
    points, faces = rectangles((0, 0, 80, 40), (0, 40, 80, 41))
    faces = np.concatenate([faces[:2], faces[2:, ::-1]])
    assert slivers(points, faces[:3], np.array([0, 0, 1])) == 0
    assert (
        slivers(points, np.concatenate([faces[:2], faces[2:, ::-1]]), np.array([0, 0, 1, 1])) == 1
    )
