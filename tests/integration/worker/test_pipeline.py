"""The whole way through the real engine: bytes in, bytes, report and picture out."""

import io
import json
import threading
import time

import numpy as np
import pytest
from partuv_contract.errors import CancelledError, MalformedGlbError, NoAreaError, OptionError
from partuv_contract.options import UnwrapOptions
from partuv_worker.glb.scene import Scene
from partuv_worker.pipeline import Unwrap, unwrap_glb
from PIL import Image

from tests.support.glb_builder import TETRAHEDRON, GlbBuilder, tetrahedron
from tests.support.glb_parse import ParsedGlb

DRACO = UnwrapOptions(compress="draco")


def torus(around, across):
    """A torus of 2 * around * across triangles."""
    u, v = np.meshgrid(
        np.linspace(0, 2 * np.pi, around, endpoint=False),
        np.linspace(0, 2 * np.pi, across, endpoint=False),
        indexing="ij",
    )
    ring = 1 + 0.4 * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], axis=-1)
    corner = np.arange(around * across).reshape(around, across)
    right, up = np.roll(corner, -1, axis=0), np.roll(corner, -1, axis=1)
    both = np.roll(right, -1, axis=1)
    faces = np.stack([corner, right, both, corner, both, up], axis=-1).reshape(-1, 3)
    builder = GlbBuilder()
    primitive = {
        "attributes": {"POSITION": builder.positions(points.reshape(-1, 3).astype("f"))},
        "indices": builder.accessor(faces.ravel().astype("I")),
    }
    builder.node(mesh=builder.mesh(primitive))
    return builder.build()


@pytest.fixture(scope="module")
def unwrapped():
    return unwrap_glb(torus(48, 24))


def test_the_asset_comes_back_with_an_atlas(unwrapped):
    before, after = ParsedGlb(torus(48, 24)), ParsedGlb(unwrapped.glb)
    assert (after.corners("POSITION") == before.corners("POSITION")).all()
    uv = after.corners("TEXCOORD_0").astype(float)
    assert uv.min() >= 0
    assert uv.max() <= 1
    sides = uv[:, 1:] - uv[:, :1]
    areas = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    assert (areas < 0).all()  # V points down, so no face is flipped


def test_the_report_is_json_and_agrees_with_itself(unwrapped):
    report = json.loads(json.dumps(unwrapped.report.model_dump()))
    assert report["faces"] == 2 * 48 * 24
    assert report["chart_count"] == len(report["charts"])
    assert sum(chart["faces"] for chart in report["charts"]) == report["faces"]
    assert sum(chart["area_share"] for chart in report["charts"]) == pytest.approx(1)
    worst = max(chart["area_distortion"] for chart in report["charts"])
    assert report["area_distortion_worst"] == worst <= 1.25
    assert 1 <= report["area_distortion_mean"] <= worst
    assert 0.95 <= report["angular_mean"] <= 1
    assert report["output_bytes"] == len(unwrapped.glb)
    assert {"reading", "writing"} < set(report["seconds"])


def test_the_preview_shows_every_chart(unwrapped):
    picture = np.asarray(Image.open(io.BytesIO(unwrapped.preview_png(256))))
    assert picture.shape == (256, 256, 3)
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > unwrapped.report.chart_count


def test_options_reach_the_engine():
    tight = unwrap_glb(torus(48, 24), UnwrapOptions(max_area_distortion=1.05))
    assert tight.report.area_distortion_worst <= 1.05


def test_the_same_bytes_for_any_number_of_threads(unwrapped):
    assert unwrap_glb(torus(48, 24), threads=2).glb == unwrapped.glb


def test_progress_never_falls_and_names_its_stage():
    run = Unwrap(UnwrapOptions())
    seen = [run.progress]
    worker = threading.Thread(target=run.run, args=(torus(160, 80),))
    worker.start()
    while worker.is_alive():
        seen.append(run.progress)
        time.sleep(0.002)
    seen.append(run.progress)
    fractions = [progress.fraction for progress in seen]
    assert fractions == sorted(fractions)
    assert seen[-1] == (1.0, "done")
    assert len({progress.stage for progress in seen}) > 3


def test_cancelling_ends_the_run_soon():
    run = Unwrap(UnwrapOptions())
    ended = []

    def work():
        with pytest.raises(CancelledError):
            run.run(torus(320, 160))
        ended.append(time.monotonic())

    worker = threading.Thread(target=work)
    worker.start()
    time.sleep(0.5)
    asked = time.monotonic()
    run.cancel()
    worker.join(30)
    assert ended[0] - asked < 2  # 0.2 s on an idle machine


def test_a_run_cancelled_before_it_starts_does_not_start():
    run = Unwrap(UnwrapOptions())
    run.cancel()
    with pytest.raises(CancelledError):
        run.run(tetrahedron().build())


def test_refusals_of_the_reader_and_of_the_engine_speak_one_language():
    with pytest.raises(MalformedGlbError):
        unwrap_glb(b"glTF" + b"\2\0\0\0" + b"\x0d\0\0\0" + b"x")
    flat = tetrahedron()
    flat.json["accessors"][1]["count"] = 3
    flat.binary = flat.binary[: 4 * 12] + bytes(6) + flat.binary[54:]  # three times vertex 0
    with pytest.raises(NoAreaError) as caught:
        unwrap_glb(flat.build())
    assert caught.value.code == "no_face_with_area"


def two_meshes(second=TETRAHEDRON):
    """Two tetrahedra, the second of other positions, in nodes and materials of their own."""
    builder = tetrahedron()
    builder.json["meshes"][0]["name"] = "First"
    primitive = {"attributes": {"POSITION": builder.positions(second)}, "indices": 1, "material": 0}
    builder.json["materials"] = [{"name": "Paint"}]
    builder.node(mesh=builder.mesh(primitive, name="Second"), translation=[5, 0, 0])
    return builder


def area_of(uv):
    sides = uv[:, 1:].astype(float) - uv[:, :1]
    return np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]).sum() / 2


def test_one_atlas_per_mesh_gives_each_the_whole_square():
    data = two_meshes(TETRAHEDRON / 8).build()
    shared = ParsedGlb(unwrap_glb(data).glb)
    result = unwrap_glb(data, UnwrapOptions(scope="mesh"))
    own = ParsedGlb(result.glb)
    assert area_of(shared.corners("TEXCOORD_0", 1)) < area_of(shared.corners("TEXCOORD_0", 0)) / 20
    assert area_of(own.corners("TEXCOORD_0", 1)) == pytest.approx(
        area_of(own.corners("TEXCOORD_0", 0)), rel=0.2
    )
    assert result.report.tile_count == 2
    assert [chart.tile for chart in result.report.charts] == [0, 1]
    assert len({chart.part for chart in result.report.charts}) == result.report.part_count == 2


def test_a_mesh_without_area_does_not_stop_the_others():
    data = two_meshes(np.zeros((4, 3), "f")).build()
    for scope in ("scene", "mesh"):
        after = ParsedGlb(unwrap_glb(data, UnwrapOptions(scope=scope)).glb)
        assert np.isfinite(after.corners("TEXCOORD_0", 1)).all()


@pytest.mark.parametrize("name", ["Second", "Paint"])
def test_only_what_is_named_is_unwrapped(name):
    data = two_meshes().build()
    result = unwrap_glb(data, UnwrapOptions(only=(name,)))
    after = ParsedGlb(result.glb)
    assert result.report.faces == 4
    assert after.primitive(0) == ParsedGlb(data).primitive(0)
    assert "TEXCOORD_0" in after.primitive(1)["attributes"]


def test_a_name_that_does_not_exist_is_an_error_that_lists_those_that_do():
    with pytest.raises(OptionError, match="'First', 'Paint', 'Second'") as caught:
        unwrap_glb(two_meshes().build(), UnwrapOptions(only=("Third",)))
    assert caught.value.pointer == "/only"


def test_the_result_can_be_compressed_without_loss():
    data = torus(64, 32)
    plain = unwrap_glb(data)
    packed = unwrap_glb(data, UnwrapOptions(compress="meshopt"))
    assert len(packed.glb) < len(plain.glb) / 2
    again, wanted = Scene(packed.glb).soup, Scene(plain.glb).soup
    assert sorted_triangles(again) == sorted_triangles(wanted)


def test_draco_is_without_loss_too():
    data = torus(64, 32)
    plain, packed = Scene(unwrap_glb(data).glb), Scene(unwrap_glb(data, DRACO).glb)
    assert b"KHR_draco_mesh_compression" in unwrap_glb(data, DRACO).glb
    for read in (lambda s: s.soup.positions[s.soup.faces], lambda s: s.existing_uv()):
        assert np.array_equal(read(packed), read(plain))


def sorted_triangles(soup):
    """Triangles as a set; the codec may start each at another corner."""
    corners = soup.positions[soup.faces]
    return sorted(
        min(np.roll(triangle, turn, axis=0).tobytes() for turn in range(3)) for triangle in corners
    )
