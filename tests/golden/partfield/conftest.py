"""The full-size network with deterministic weights."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.util import find_spec
from typing import TYPE_CHECKING

import pytest

from tests.support.partfield import filled_state

if TYPE_CHECKING:
    from partuv_worker.features.partfield.network import PartFieldNetwork
    from torch import Tensor

collect_ignore_glob = [] if find_spec("torch") else ["test_*.py"]


@pytest.fixture(scope="session")
def full_state() -> dict[str, Tensor]:
    from partuv_worker.features.partfield.network import expected_parameters

    return filled_state(expected_parameters())


@pytest.fixture(scope="session")
def full_network(full_state: dict[str, Tensor]) -> Iterator[PartFieldNetwork]:
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
