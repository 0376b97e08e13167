import numpy as np
import pytest
from partuv_worker.measure import areas_3d, signed_areas_2d
from partuv_worker.repack.scale import scaled_charts

TRIANGLE = np.array([[0, 0], [1, 0], [0, 1.0]])


def charts(*sizes):
    """A triangle each: (its size in UV, its size in space)."""
    uv = np.array([flat * TRIANGLE + 0.3 for flat, _ in sizes])
    corners = np.array([solid * np.pad(TRIANGLE, ((0, 0), (0, 1))) for _, solid in sizes])
    return uv, corners, np.arange(len(sizes))


def test_uniform_gives_every_chart_the_area_of_its_surface():
    uv, corners, chart = charts((1, 1), (0.1, 3), (7, 0.5))
    scaled, no_size = scaled_charts(uv, corners, chart, "uniform")
    assert signed_areas_2d(scaled) == pytest.approx(areas_3d(corners))
    assert not len(no_size)


def test_keep_leaves_the_charts_as_large_to_each_other_as_they_are():
    uv, corners, chart = charts((1, 1), (0.1, 3), (7, 0.5))
    scaled, _ = scaled_charts(uv, corners, chart, "keep")
    ratio = signed_areas_2d(scaled) / signed_areas_2d(uv)
    assert ratio == pytest.approx(np.full(3, ratio[0]))
    assert signed_areas_2d(scaled).sum() == pytest.approx(areas_3d(corners).sum())


def test_a_chart_drawn_out_to_a_thread_does_not_dwarf_the_others():
    uv, corners, chart = charts((1, 1), (1, 1))
    uv[1, :, 1] *= 1e-6
    scaled, _ = scaled_charts(uv, corners, chart, "uniform")
    assert np.ptp(scaled[1], axis=0).max() < 4
    assert signed_areas_2d(scaled)[0] == pytest.approx(0.5)


def test_a_speck_stays_visible():
    uv, corners, chart = charts((1, 1), (1, 1e-9))
    scaled, _ = scaled_charts(uv, corners, chart, "uniform")
    assert 1e-5 < np.ptp(scaled[1], axis=0).max() < 1e-3


@pytest.mark.parametrize("how", ["uniform", "keep"])
def test_lines_and_points_have_no_size_unless_their_surface_has_none(how):
    uv, corners, chart = charts((1, 1), (0, 1), (1, 1), (0, 0), (1, 0))
    uv[2, :, 1] = uv[2, :, 0]
    scaled, no_size = scaled_charts(uv, corners, chart, how)
    assert no_size.tolist() == [1, 2]
    assert np.isfinite(scaled).all()
