"""The full-size network against recorded values of the published implementation.

The recordings are not part of this repository; where they are absent these tests skip, and
`tests/unit/worker/features/test_network.py` holds the arithmetic to a second implementation.
"""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from partuv_worker.features.partfield import point_voxel
from partuv_worker.features.partfield.lookup import point_means
from partuv_worker.features.partfield.network import PartFieldNetwork, expected_parameters
from partuv_worker.features.partfield.sampling import (
    face_points,
    normalised_positions,
    surface_cloud,
)
from torch import Tensor, nn

RECORDED = Path(__file__).parents[4] / "shared" / "partfield"
pytestmark = pytest.mark.skipif(
    not (RECORDED / "golden.npz").exists(), reason="no recorded values beside the repository"
)

Recording = dict[str, NDArray[Any]]


@pytest.fixture(scope="module")
def recorded() -> Recording:
    with np.load(RECORDED / "golden.npz", allow_pickle=False) as file:
        return dict(file)


def relative_rms(values: NDArray[Any], expected: NDArray[Any]) -> float:
    wanted = expected.astype(np.float64)
    return float(np.sqrt(np.square(values - wanted).mean() / np.square(wanted).mean()))


def test_parameters_are_those_of_the_published_checkpoint() -> None:
    listed = json.loads((RECORDED / "state_dict.json").read_text())
    assert expected_parameters() == {name: tuple(shape) for name, shape in listed.items()}


def test_weights_are_the_recorded_fill(full_state: dict[str, Tensor], recorded: Recording) -> None:
    sums = [full_state[name].double().sum().item() for name in sorted(full_state)]
    np.testing.assert_allclose(sums, recorded["fill_sum"], rtol=1e-9, atol=1e-9)


def test_every_stage_matches(full_network: PartFieldNetwork, recorded: Recording) -> None:
    errors: dict[str, float] = {}

    def compare(stage: str, values: Tensor) -> None:
        assert tuple(values.shape) == tuple(recorded[f"{stage}_shape"]), stage
        index = torch.from_numpy(recorded[f"{stage}_idx"]).long()
        got = values.reshape(-1)[index].numpy()
        errors[stage] = relative_rms(got, recorded[f"{stage}_val"])

    with torch.inference_mode():
        planes = run_stages(full_network, torch.from_numpy(recorded["pc"]), compare)
        table = planes.reshape(-1, planes.shape[-1])
        queries = torch.from_numpy(recorded["query"])[:, None]
        features = point_means(table, queries, full_network.shape.plane).numpy()

    assert set(errors) == {name[:-4] for name in recorded if name.endswith("_val")} - {
        "pf_planes",
        "pu_planes",
    }
    assert max(errors.values()) <= 1e-5, errors
    assert np.abs(features[:, 64:] - recorded["query_feat"]).max() <= 2e-4
    assert np.abs(features[:, :64] - recorded["query_sdf_feat"]).max() <= 2e-4


@pytest.mark.parametrize(("frame", "prefix"), [("partfield", "pf"), ("partuv", "pu")])
def test_mesh_to_face_features(
    full_network: PartFieldNetwork, recorded: Recording, frame: Any, prefix: str
) -> None:
    faces = recorded["mesh_f"]
    placed = normalised_positions(recorded["mesh_v"].astype(np.float64), frame)
    np.testing.assert_allclose(placed, recorded[f"{prefix}_vn"], rtol=0, atol=1e-15)

    cloud, cloud_faces = surface_cloud(placed, faces, 100_000, seed=42)
    np.testing.assert_array_equal(cloud[:64], recorded[f"{prefix}_pc_head"])
    np.testing.assert_array_equal(cloud_faces[:64], recorded[f"{prefix}_pc_face_head"])
    points = cloud.astype(np.float64)
    number = np.arange(len(points))[:, None]
    check = [points.sum(), np.abs(points).sum(), (points * number).sum() / 1e5]
    np.testing.assert_allclose(check, recorded[f"{prefix}_pc_check"], rtol=1e-7)

    draws = np.stack(list(recorded[f"{prefix}_u"]), axis=-1)
    samples = torch.from_numpy(face_points(placed[faces].astype(np.float32), draws))
    with torch.inference_mode():
        planes = full_network(torch.from_numpy(cloud))
        features = point_means(planes.reshape(-1, 448), samples, 128).numpy()
    wanted = recorded[f"{prefix}_face_feat"]
    assert np.abs(features - wanted).max() <= 1e-2
    assert relative_rms(features, wanted) <= 3e-4


def run_stages(
    network: PartFieldNetwork, points: Tensor, see: Callable[[str, Tensor], None]
) -> Tensor:
    """All output planes, 3 x R x R x 512; `see` gets each stage, channels first."""

    def rows(x: Tensor) -> Tensor:
        return x.T[None]

    def image(x: Tensor) -> Tensor:
        return x.permute(0, 3, 1, 2)[None]

    def keep(x: Tensor) -> Tensor:
        return x

    block = network.pvcnn.pc_encoder.encoder[0]
    unet = network.pvcnn.unet_encoder
    head = network.triplane_transformer
    seen: list[tuple[nn.Module, str, Callable[[Any], Tensor]]] = [
        (block.point_features, "pt_mlp", rows),
        (block, "fused", rows),
        (unet, "unet_out", image),
        (head.transformer.layers[0], "tf_layer0", keep),
        (head.transformer.layers[-1], "tf_layer5", keep),
        (head.transformer, "tf_out", keep),
    ]
    seen += [(step, f"unet_down{i}_skip", keep) for i, step in enumerate(unet.down_convs)]
    seen += [(step, f"unet_up{i}", keep) for i, step in enumerate(unet.up_convs)]
    mixer = unet.down_convs[0].block.conv_3daware
    seen += [(mixer, f"unet_down0_3daware_plane{i}", lambda out, i=i: out[i]) for i in range(3)]

    def observer(name: str, change: Callable[[Any], Tensor]) -> Callable[..., None]:
        return lambda module, inputs, output: see(name, change(output))

    def see_volume(module: nn.Module, inputs: Any, output: Tensor) -> None:
        see("vox_in", inputs[0])
        see("vox_conv", output)
        cells = output[0].flatten(1).T
        position = point_voxel.grid_position(points, block.grid)
        see("devox", rows(point_voxel.devoxelise(cells, position, block.grid)))

    low: list[Tensor] = []

    def see_low(module: nn.Module, inputs: Any, output: Tensor) -> None:
        low.append(output)
        if len(low) == len(point_voxel.PLANE_AXES):
            see("down_tokens_map", torch.cat(low))

    def see_planes(module: nn.Module, inputs: Any) -> None:
        see("planes_pre", image(inputs[0]))

    def see_tokens(module: nn.Module, inputs: Any) -> None:
        see("tf_in", inputs[0])

    handles = [module.register_forward_hook(observer(name, by)) for module, name, by in seen]
    handles.append(block.voxel_layers.register_forward_hook(see_volume))
    handles.append(head.downsampler.register_forward_hook(see_low))
    handles.append(unet.register_forward_pre_hook(see_planes))
    handles.append(head.transformer.register_forward_pre_hook(see_tokens))
    try:
        every = slice(0, network.shape.channels)
        planes = network.pvcnn(points)
        tokens = head.transformer(head.tokens(planes))
        upsampled, shortcut = head.upsample(tokens, every), head.shortcut(planes, every)
        see("upsampled", upsampled.permute(0, 3, 1, 2))
        see("mlp_out", shortcut[None])
        see("planes", image(upsampled + shortcut))
        return upsampled + shortcut
    finally:
        for handle in handles:
            handle.remove()
