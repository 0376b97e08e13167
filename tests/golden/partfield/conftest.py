"""Deterministic weights: an integer hash of each parameter's place, scaled by its fan-in.

The checkpoint may not be distributed; these weights exercise every path of the network instead. A
hash, not a ramp: matrices of a ramp have rank two and hide transposed axes.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np
import pytest
from numpy.typing import NDArray

if TYPE_CHECKING:
    import torch
    from partuv_worker.features.partfield.network import PartFieldNetwork

collect_ignore_glob = [] if find_spec("torch") else ["test_*.py"]


def hash_uniform(count: int, salt: int) -> NDArray[np.float64]:
    """Uniform in (-1, 1), one value per index."""
    x = np.arange(count, dtype=np.uint32) + np.uint32(salt * 0x9E3779B1 & 0xFFFFFFFF)
    x ^= x >> np.uint32(16)
    x *= np.uint32(0x7FEB352D)
    x ^= x >> np.uint32(15)
    x *= np.uint32(0x846CA68B)
    x ^= x >> np.uint32(16)
    return (x + 0.5) * (2 / 2**32) - 1


def filled_state(shapes: dict[str, tuple[int, ...]]) -> dict[str, torch.Tensor]:
    """A value for every parameter, float32."""
    import torch

    state = {}
    for number, name in enumerate(sorted(shapes)):
        shape = shapes[name]
        count = math.prod(shape)
        r = hash_uniform(count, number + 1)
        if name.endswith("pos_embed"):
            r *= 0.5
        elif len(shape) > 1:
            fan = shape[0] if name.endswith("upsampler.weight") else count / shape[0]
            r *= math.sqrt(3 / fan)
        else:
            r *= 0.1
            if name.endswith(".weight"):
                r += 1
        state[name] = torch.from_numpy(r.astype(np.float32).reshape(shape))
    return state


@pytest.fixture(scope="session")
def full_state() -> dict[str, torch.Tensor]:
    from partuv_worker.features.partfield.network import expected_parameters

    return filled_state(expected_parameters())


@pytest.fixture(scope="session")
def full_network(full_state: dict[str, torch.Tensor]) -> Iterator[PartFieldNetwork]:
    import torch
    from partuv_worker.features.partfield.network import PartFieldNetwork

    with torch.device("meta"):
        network = PartFieldNetwork()
    network.load_state_dict(full_state, strict=True, assign=True)
    # Threads that wait for each other actively are slower than one where other tests run beside.
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield network.requires_grad_(False).eval()
    torch.set_num_threads(threads)
