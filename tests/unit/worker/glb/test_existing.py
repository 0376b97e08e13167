import numpy as np
import pytest
from partuv_contract.errors import MalformedGlbError, UnusableUvError
from partuv_worker.glb.scene import Scene

from tests.support.glb_builder import TETRAHEDRON_FACES, tetrahedron

UV = np.array([[0, 0], [1, 0.25], [0.5, 1], [0.125, 3]], "f")


def with_uv(values, **more):
    builder = tetrahedron()
    accessor = builder.accessor(values, **more)
    builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = accessor
    return builder


def test_uvs_come_per_corner_with_v_up():
    found = Scene(with_uv(UV).build()).existing_uv()
    assert np.array_equal(found, (UV * (1, -1))[TETRAHEDRON_FACES])


def test_corners_of_a_mirrored_mesh_come_in_the_order_of_the_soup():
    builder = with_uv(UV)
    builder.json["nodes"][0]["scale"] = [-1, 1, 1]
    found = Scene(builder.build()).existing_uv()
    assert np.array_equal(found, (UV * (1, -1))[TETRAHEDRON_FACES[:, ::-1]])


def test_normalised_integers_are_read():
    found = Scene(with_uv(np.full((4, 2), 51, "B"), normalized=True).build()).existing_uv()
    assert np.allclose(found, (0.2, -0.2))


def test_a_missing_set_is_refused_with_the_primitive():
    with pytest.raises(UnusableUvError, match="primitive 0 of mesh 0 has no TEXCOORD_0") as caught:
        Scene(tetrahedron().build()).existing_uv()
    assert caught.value.pointer == "/meshes/0/primitives/0"


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_uvs_that_are_not_finite_are_refused_with_the_primitive(bad):
    values = UV.copy()
    values[3, 1] = bad
    with pytest.raises(
        UnusableUvError, match=r"primitive 0 of mesh 0 .* vertices 0, 1, 3"
    ) as caught:
        Scene(with_uv(values).build()).existing_uv()
    assert caught.value.pointer == "/meshes/0/primitives/0"


def test_uvs_of_another_kind_are_malformed():
    with pytest.raises(MalformedGlbError, match="two numbers"):
        Scene(with_uv(np.zeros((4, 3), "f")).build()).existing_uv()
