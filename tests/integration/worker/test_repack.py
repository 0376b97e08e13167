"""Repacking through the real engine: charts stay what they are, and get gutter and texels."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from partuv_contract.errors import CancelledError, OptionError, UnusableUvError
from partuv_contract.options import UnwrapOptions
from partuv_worker import samples
from partuv_worker.measure import areas_3d, signed_areas_2d
from partuv_worker.pipeline import Unwrap, unwrap_glb
from PIL import Image

from tests.support.atlas import least_gutter, overlaps
from tests.support.glb_builder import grid, tetrahedron
from tests.support.glb_parse import ParsedGlb
from tests.support.patches import patch_builder, patches, similarity

ROBOT = Path(samples.__file__).with_name("robot.glb").read_bytes()


def repacked(data, threads=1, **options):
    return unwrap_glb(data, UnwrapOptions.parse({"mode": "repack"} | options), threads=threads)


def written_uv(data, mesh=0, name="TEXCOORD_0"):
    """As in the file, but V up."""
    uv = ParsedGlb(data).corners(name, mesh).astype(float)
    return uv * (1, -1) + (0, 1)


def check_charts(made, result, *, gutter, resolution, scale):
    uv = written_uv(result.glb)
    assert (ParsedGlb(result.glb).corners("POSITION") == made.corners).all()
    assert np.array_equal(result.atlas.chart, made.chart)
    assert uv.min() >= gutter / 2 / resolution
    assert uv.max() <= 1 - gutter / 2 / resolution
    assert least_gutter(uv, made.chart) >= gutter / resolution
    assert not overlaps(uv)
    before = made.uv.astype(float) * (1, -1)
    factors, densities = [], []
    for number in range(made.chart.max() + 1):
        own = made.chart == number
        factor, miss = similarity(before[own].reshape(-1, 2), uv[own].reshape(-1, 2))
        assert miss < 2e-7
        factors.append(factor)
        densities.append(np.abs(signed_areas_2d(uv[own])).sum() / areas_3d(made.corners[own]).sum())
    same = factors if scale == "keep" else densities
    assert np.allclose(same, same[0], rtol=1e-3)


@settings(max_examples=15, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 10**6),
    count=st.integers(1, 12),
    scale=st.sampled_from(["uniform", "keep"]),
    gutter=st.sampled_from([0.0, 4.0, 9.5]),
    resolution=st.sampled_from([512, 1024]),
)
def test_charts_keep_their_shape_and_get_a_gutter(seed, count, scale, gutter, resolution):
    made = patches(seed, count)
    result = repacked(
        patch_builder(made).build(),
        repack_scale=scale,
        gutter_texels=gutter,
        resolution=resolution,
    )
    check_charts(made, result, gutter=gutter, resolution=resolution, scale=scale)


@pytest.fixture(scope="module")
def nine():
    return patch_builder(patches(4, 9))


def test_the_report_and_the_pictures_show_the_kept_charts(nine):
    result = repacked(nine.build())
    report = result.report
    assert report.mode == "repack"
    assert report.features is None
    assert report.noise is None
    assert report.chart_count == len(report.charts) == 9
    assert sum(chart.faces for chart in report.charts) == report.faces
    assert sum(chart.area_share for chart in report.charts) == pytest.approx(1)
    assert {"reading", "charts", "packing", "writing"} < set(report.seconds)
    assert report.tiles[0].gutter_texels >= 4
    assert not report.notes
    shown = np.asarray(Image.open(io.BytesIO(result.preview_png(256))))
    assert len(np.unique(shown.reshape(-1, 3), axis=0)) > 9
    assert result.preview_svg().count(b"<path") >= 9


def test_the_same_bytes_for_any_number_of_threads(nine):
    assert repacked(nine.build(), threads=2).glb == repacked(nine.build()).glb


@pytest.mark.parametrize("existing_uv", ["keep", "append", "replace"])
def test_the_old_set_goes_where_existing_uv_says(nine, existing_uv):
    data = nine.build()
    old = ParsedGlb(data).corners("TEXCOORD_0")
    after = ParsedGlb(repacked(data, existing_uv=existing_uv).glb)
    sets = {name for name in after.primitive()["attributes"] if name.startswith("TEXCOORD")}
    if existing_uv == "replace":
        assert sets == {"TEXCOORD_0"}
        assert not (after.corners("TEXCOORD_0") == old).all()
    else:
        kept = "TEXCOORD_1" if existing_uv == "keep" else "TEXCOORD_0"
        assert sets == {"TEXCOORD_0", "TEXCOORD_1"}
        assert (after.corners(kept) == old).all()


def test_what_was_unwrapped_is_repacked_at_another_gutter_with_as_many_charts():
    first = unwrap_glb(ROBOT)
    again = repacked(first.glb, gutter_texels=16, existing_uv="replace")
    assert again.report.chart_count == first.report.chart_count
    assert again.report.tiles[0].gutter_texels >= 16
    assert again.report.angular_mean == pytest.approx(first.report.angular_mean, abs=0.02)
    assert again.report.area_distortion_worst <= first.report.area_distortion_worst + 1e-3


def test_parts_are_primitives_unless_others_are_asked_for(nine):
    data = nine.build()
    assert repacked(data).report.part_count == 1
    result = repacked(data, parts=9, group_by_part="strict")
    assert result.report.part_count == 9
    assert result.report.features.prior == "geometric"
    assert sorted(chart.part for chart in result.report.charts) == list(range(9))


def test_tiles_hold_whole_primitives():
    builder, other = patch_builder(patches(4, 5)), patches(7, 4)
    builder.json["meshes"][0]["primitives"].append(
        {
            "attributes": {
                "POSITION": builder.positions(other.corners.reshape(-1, 3)),
                "TEXCOORD_0": builder.accessor(other.uv.reshape(-1, 2)),
            }
        }
    )
    result = repacked(builder.build(), tiles="per_part")
    tiles = {(chart.part, chart.tile) for chart in result.report.charts}
    assert result.report.tile_count == len(tiles) == 2


def test_each_mesh_has_its_own_atlas_with_scope_mesh(nine):
    builder, other = patch_builder(patches(4, 5)), patches(7, 3)
    second = {
        "attributes": {
            "POSITION": builder.positions(other.corners.reshape(-1, 3)),
            "TEXCOORD_0": builder.accessor(other.uv.reshape(-1, 2)),
        }
    }
    builder.node(mesh=builder.mesh(second))
    result = repacked(builder.build(), scope="mesh")
    assert [chart.tile for chart in result.report.charts] == [0] * 5 + [1] * 3
    for mesh in (0, 1):
        uv = written_uv(result.glb, mesh)
        assert np.ptp(uv.reshape(-1, 2), axis=0).max() > 0.9


def folded():
    """A sheet whose halves lie on the same texels, and the turned edge between them is a fold."""
    points, faces = grid(4, 2)
    builder = tetrahedron()
    uv = (np.abs(points[:, :2] - (2, 0)) / 4).astype("f")
    attributes = {"POSITION": builder.positions(points), "TEXCOORD_0": builder.accessor(uv)}
    indices = builder.accessor(faces.ravel().astype("H"))
    builder.json["meshes"][0]["primitives"] = [{"attributes": attributes, "indices": indices}]
    return builder.build()


def test_halves_that_shared_their_texels_get_texels_of_their_own():
    result = repacked(folded())
    assert result.report.chart_count == 2
    assert not overlaps(written_uv(result.glb))


def test_a_chart_with_a_flipped_face_is_kept_whole_and_noted():
    points, faces = grid(8, 8)
    flat = points[:, :2].copy()
    flat[40] += (1.4, 0)  # an inner vertex, pulled across its neighbours
    builder = tetrahedron()
    attributes = {"POSITION": builder.positions(points), "TEXCOORD_0": builder.accessor(flat)}
    indices = builder.accessor(faces.ravel().astype("H"))
    builder.json["meshes"][0]["primitives"] = [{"attributes": attributes, "indices": indices}]
    result = repacked(builder.build())
    assert result.report.chart_count == 1
    assert "1 of the kept charts" in result.report.notes[0]


@pytest.mark.parametrize("scale", ["uniform", "keep"])
@pytest.mark.parametrize("powers", [(37, 37), (-42, -42), (-30, 0, 30)], ids=str)
def test_uvs_of_any_size_are_packed(powers, scale):
    made = patches(3, 12)
    size = np.array([10.0**power for power in powers])[made.chart % len(powers)]
    made.uv[:] = made.uv.astype(float) * size[:, None, None]
    result = repacked(patch_builder(made).build(), repack_scale=scale)
    uv = written_uv(result.glb)
    assert result.report.chart_count == 12
    assert 0 <= uv.min() < uv.max() <= 1
    assert result.report.tiles[0].gutter_texels >= 4


def test_charts_without_area_are_refused_with_the_primitive():
    made = patches(4, 3)
    made.uv[made.chart == 1] = 0.5
    with pytest.raises(UnusableUvError, match="primitive 0 of mesh 0") as caught:
        repacked(patch_builder(made).build())
    assert caught.value.pointer == "/meshes/0/primitives/0"


def test_only_named_meshes_need_uvs():
    builder = patch_builder(patches(4, 3))
    builder.json["meshes"][0]["name"] = "Skin"
    builder.node(
        mesh=builder.mesh({"attributes": {"POSITION": builder.positions(np.eye(3, dtype="f"))}})
    )
    data = builder.build()
    with pytest.raises(UnusableUvError, match="primitive 0 of mesh 1 has no TEXCOORD_0"):
        repacked(data)
    result = repacked(data, only=("Skin",))
    assert ParsedGlb(result.glb).primitive(1) == ParsedGlb(data).primitive(1)


def test_options_that_mean_nothing_here_are_refused():
    with pytest.raises(OptionError, match="max_area_distortion: has no meaning with mode: repack"):
        UnwrapOptions.parse({"mode": "repack", "max_area_distortion": 1.5})
    with pytest.raises(OptionError, match="repack_scale: has no meaning with mode: unwrap"):
        UnwrapOptions.parse({"repack_scale": "keep"})


def test_a_cancelled_run_does_not_pack(nine):
    run = Unwrap(UnwrapOptions(mode="repack"))
    run.cancel()
    with pytest.raises(CancelledError):
        run.run(nine.build())
