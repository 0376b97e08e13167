"""Texel weights through the pipeline: charts of what is named get that many times the texels."""

import numpy as np
import pytest
from partuv_contract.errors import OptionError
from partuv_contract.options import UnwrapOptions
from partuv_worker.measure import areas_3d, signed_areas_2d
from partuv_worker.pipeline import UnwrapResult, unwrap_glb

from tests.support.atlas import least_gutter, overlaps
from tests.support.glb_builder import GlbBuilder, grid
from tests.support.glb_parse import ParsedGlb

NAMES = ("Cloth", "Skin", "Metal")


def sheets() -> bytes:
    """A flat sheet of each material, and one without any; they do not touch."""
    builder = GlbBuilder()
    builder.json["materials"] = [{"name": name} for name in NAMES]
    primitives = []
    for number in range(len(NAMES) + 1):
        points, faces = grid(3 + number, 4)
        uv = points[:, :2] / 10
        primitive = {
            "attributes": {
                "POSITION": builder.positions(points + np.array([20 * number, 0, 0], "f")),
                "TEXCOORD_0": builder.accessor(uv),
            },
            "indices": builder.accessor(faces.ravel().astype("H")),
        }
        if number < len(NAMES):
            primitive["material"] = number
        primitives.append(primitive)
    builder.node(mesh=builder.mesh(*primitives))
    return builder.build()


def densities(result: UnwrapResult) -> np.ndarray:
    """Texels along a unit of length of each primitive, relative to the last one."""
    parsed = ParsedGlb(result.glb)
    found = []
    for piece in result.soup.pieces:
        own = piece.primitive
        uv = parsed.corners("TEXCOORD_0", own.mesh, own.number).astype(float)
        solid = parsed.corners("POSITION", own.mesh, own.number).astype(float)
        found.append(np.sqrt(np.abs(signed_areas_2d(uv)).sum() / areas_3d(solid).sum()))
    return np.array(found) / found[-1]


def unwrapped(data: bytes, **options: object) -> UnwrapResult:
    result = unwrap_glb(data, UnwrapOptions.parse(options), threads=2)
    uv = result.atlas.corner_uv.astype(float)
    asked = 4.0 if "tiles" not in options else 0.0
    assert least_gutter(uv, result.atlas.chart) >= asked / 1024
    if asked:
        assert not overlaps(uv)
    return result


@pytest.mark.parametrize("mode", ["unwrap", "repack"])
def test_materials_get_their_weights(mode: str) -> None:
    weights = ["material:Skin=2", "material:Metal=0.5"]
    result = unwrapped(sheets(), mode=mode, texel_weights=weights)
    np.testing.assert_allclose(densities(result), [1, 2, 0.5, 1], rtol=1e-3)
    np.testing.assert_allclose(densities(unwrapped(sheets(), mode=mode)), 1, rtol=1e-3)


@pytest.mark.parametrize("mode", ["unwrap", "repack"])
def test_parts_get_their_weights(mode: str) -> None:
    options = {"mode": mode, "parts": 4}
    plain = unwrapped(sheets(), **options)
    weights = ["part:1=3", "part:2=0.25", "material:Skin=2"]
    result = unwrapped(sheets(), texel_weights=weights, **options)
    np.testing.assert_array_equal(result.atlas.part, plain.atlas.part)
    factor = {1: 3.0, 2: 0.25}
    wanted = []
    for number, piece in enumerate(result.soup.pieces):
        part = result.atlas.part[piece.first_face]
        skin = 2.0 if number == 1 else 1.0
        wanted.append(factor.get(part, 1.0) * skin)
    assert len(set(wanted)) > 2
    np.testing.assert_allclose(densities(result), np.divide(wanted, wanted[-1]), rtol=1e-3)


def test_a_chart_over_several_materials_takes_the_largest_weight() -> None:
    points, faces = grid(4, 4)
    builder = GlbBuilder()
    builder.json["materials"] = [{"name": name} for name in NAMES]
    positions = builder.positions(points)
    primitives = [
        {
            "attributes": {"POSITION": positions},
            "indices": builder.accessor(half.ravel().astype("H")),
            "material": number,
        }
        for number, half in enumerate((faces[:16], faces[16:]))
    ]
    far, apart = grid(4, 4)
    primitives.append(
        {
            "attributes": {"POSITION": builder.positions(far + np.array([9, 0, 0], "f"))},
            "indices": builder.accessor(apart.ravel().astype("H")),
        }
    )
    builder.node(mesh=builder.mesh(*primitives))
    result = unwrapped(builder.build(), texel_weights=["material:Cloth=0.5", "material:Skin=3"])
    assert result.report.chart_count == 2
    np.testing.assert_allclose(densities(result), [3, 3, 1], rtol=1e-3)


def test_weights_hold_at_a_fixed_density() -> None:
    options = {"texel_density": 20.0, "texel_weights": ["material:Skin=2"]}
    result = unwrapped(sheets(), **options)
    uv = result.atlas.corner_uv.astype(float)
    solid = result.soup.positions[result.soup.faces]
    last = result.soup.pieces[-1].first_face
    texels = np.abs(signed_areas_2d(uv[last:] * 1024)).sum()
    assert np.sqrt(texels / areas_3d(solid[last:]).sum()) == pytest.approx(20.0, rel=1e-4)
    np.testing.assert_allclose(densities(result), [1, 2, 1, 1], rtol=1e-3)


@pytest.mark.parametrize("mode", ["unwrap", "repack"])
@pytest.mark.parametrize(
    ("item", "said"),
    [
        ("material:Gold=2", "no material is named 'Gold'; there are: 'Cloth', 'Metal', 'Skin'"),
        ("part:4=2", "there is no part 4, the last is 3"),
    ],
)
def test_unknown_names_are_told(mode: str, item: str, said: str) -> None:
    with pytest.raises(OptionError) as refused:
        unwrapped(sheets(), mode=mode, parts=4, texel_weights=[item])
    assert said in str(refused.value)
    assert refused.value.pointer == "/texel_weights"
