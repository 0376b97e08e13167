import sys
from pathlib import Path

import numpy as np
import pytest

from bench.compare.judge import judge
from tests.support.glb_builder import grid
from tests.support.uv import seamless, separate_faces

SHARED = Path(__file__).parents[4] / "shared"

# Two unit squares side by side, cut apart in UV; a gap of 1/8 between them.
POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0.0]])
FACES = np.array([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])


def two_squares(shift: float) -> np.ndarray:
    uv = POSITIONS[FACES][:, :, :2] / 4
    uv[2:, :, 0] += shift
    return uv


def test_charts_seam_gutter_and_efficiency_of_two_squares():
    figures = judge(POSITIONS, FACES, two_squares(1 / 8))
    assert figures.charts == 2
    assert figures.single_face_charts == 0
    assert figures.seam_length == pytest.approx(1 / np.sqrt(2))
    assert figures.gutter_texels == pytest.approx(128)
    assert figures.efficiency == pytest.approx(2 * 0.25**2 / 0.625**2)
    assert figures.angular_mean == pytest.approx(1)
    assert figures.angular_all_frames == pytest.approx(1)
    assert figures.area_distortion_worst == pytest.approx(1)
    assert (figures.flipped_faces, figures.overlapping_pairs) == (0, 0)
    assert figures.overlaps_complete


def test_an_uncut_sheet_is_one_chart_without_gutter():
    figures = judge(POSITIONS, FACES, two_squares(0))
    assert (figures.charts, figures.seam_length, figures.gutter_texels) == (1, 0, None)


def test_charts_on_one_another_overlap_and_leave_no_gutter():
    figures = judge(POSITIONS, FACES, two_squares(-1 / 8))
    assert figures.charts == 2
    assert figures.overlapping_pairs == 3  # half a square each: three of the four pairs meet
    assert figures.gutter_texels == 0


def test_charts_that_touch_do_not_overlap():
    uv = two_squares(0)
    uv[2:, :, 1] += 1 / 8  # along the seam: another chart, at no distance
    figures = judge(POSITIONS, FACES, uv)
    assert (figures.charts, figures.overlapping_pairs, figures.gutter_texels) == (2, 0, 0)


def test_a_folded_corner_is_a_flip():
    uv = two_squares(0)
    uv[1, 2] = [0.25, 0.125]  # vertex 3, of face 1 alone, over the diagonal
    figures = judge(POSITIONS, FACES, uv)
    assert (figures.charts, figures.flipped_faces) == (1, 1)
    assert figures.overlapping_pairs > 0


def test_the_worst_chart_counts_not_the_mean():
    uv = two_squares(1 / 8)
    uv[3, 2, 1] += 0.25  # the triangle that this corner belongs to gets twice its area
    figures = judge(POSITIONS, FACES, uv)
    # Of one chart the two faces, equal in space, get 1/3 and 2/3: 2/3 and 4/3 of their due.
    assert figures.charts == 2
    assert figures.area_distortion_worst == pytest.approx((1.5 + 4 / 3) / 2)
    assert figures.area_distortion_mean == pytest.approx((1.5 + 4 / 3 + 2) / 4)


def test_a_stretch_along_an_axis_is_seen_in_all_frames_only():
    uv = two_squares(0) * (0.5, 1)
    figures = judge(POSITIONS, FACES, uv)
    assert figures.angular_mean == pytest.approx(1)
    assert figures.angular_all_frames == pytest.approx(1 - 2 / np.pi * np.arcsin(3 / 5))


def atlases() -> dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]]:
    random = np.random.default_rng(7)
    points, faces = grid(14, 11)
    points = points + random.normal(0, 0.15, points.shape)
    flat = seamless(points, faces).astype(float)
    cells = separate_faces(len(faces)).astype(float)
    mixed = np.where(np.arange(len(faces))[:, None, None] < 60, cells / 2, flat / 2 + (0.5, 0))
    # Four faces around one edge: two smooth pairs, then two pairs of which one is cut.
    fins = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]])
    fin_faces = np.array([[0, 1, 2], [1, 0, 4], [0, 1, 3], [1, 0, 5]])
    pairs = np.array([[[0, 0], [0, 1], [1, 0]], [[0, 1], [0, 0], [-1, 0.0]]])
    smooth = np.concatenate([pairs, pairs + np.array([3, 0])]) / 8 + 0.125
    cut = smooth.copy()
    cut[3, :, 1] += 0.25
    return {
        "smooth fins": (fins, fin_faces, smooth),
        "fins, one pair cut": (fins, fin_faces, cut),
        "folded sheet": (points, faces, flat),
        "a chart per face": (points, faces, cells),
        "some of both": (points, faces, mixed),
        "charts in a heap": (points, faces, mixed % 0.4),
        "outside of the square": (points, faces, 7 * mixed - 3),
        "mirrored": (points, faces, mixed * (-1, 1) + (1, 0)),
    }


@pytest.mark.skipif(not (SHARED / "uvmetrics").is_dir(), reason="the other judge is not at hand")
@pytest.mark.parametrize("name", atlases())
def test_agrees_with_the_other_judge(name, monkeypatch):
    monkeypatch.setattr(sys, "path", [*sys.path, str(SHARED)])
    from uvmetrics import evaluate

    positions, faces, uv = atlases()[name]
    ours, theirs = judge(positions, faces, uv), evaluate(positions, faces, uv)
    assert ours.charts == theirs["n_charts"]
    assert ours.single_face_charts == theirs["n_single_triangle_charts"]
    assert ours.area_distortion_worst == pytest.approx(theirs["area_distortion"])
    assert ours.area_distortion_mean == pytest.approx(theirs["area_distortion_overall"])
    assert ours.angular_mean == pytest.approx(theirs["angular"])
    assert ours.angular_all_frames == pytest.approx(theirs["angular_all_frames"])
    assert ours.seam_length == pytest.approx(theirs["seam_length_3d"])
    assert ours.flipped_faces == theirs["n_flipped_faces"]
    assert ours.overlapping_pairs == (
        theirs["n_overlap_pairs_intra"] + theirs["n_overlap_pairs_inter"]
    )
    assert ours.gutter_texels == pytest.approx(theirs["gutter_texels_1024"], abs=1e-6)
    assert ours.efficiency == pytest.approx(theirs["packing_efficiency"])
