"""A network small enough for loops. Nothing in this folder is collected where torch is missing."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest
from partuv_worker.features.partfield.shape import NetworkShape

if TYPE_CHECKING:
    from partuv_worker.features.partfield.network import PartFieldNetwork

collect_ignore_glob = [] if find_spec("torch") else ["test_*.py"]

TINY = NetworkShape(
    plane=16,
    voxel_grids=(4, 2, 2, 2),
    point_channels=(8, 4, 4, 8),
    unet_channels=(4, 8, 8),
    norm_groups=2,
    width=8,
    heads=2,
    layers=2,
    channels=12,
    sdf_channels=4,
)


@pytest.fixture(scope="session")
def tiny_shape() -> NetworkShape:
    return TINY


@pytest.fixture
def tiny_network() -> PartFieldNetwork:
    """Random weights, the same in every run."""
    import torch
    from partuv_worker.features.partfield.network import PartFieldNetwork

    generator = torch.Generator().manual_seed(5)
    network = PartFieldNetwork(TINY)
    state = {
        name: torch.randn(tensor.shape, generator=generator) * 0.5
        for name, tensor in network.state_dict().items()
    }
    network.load_state_dict(state)
    return network.requires_grad_(False).eval()
