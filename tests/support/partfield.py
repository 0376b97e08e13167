"""Weights and checkpoints for PartField; the published file may not be distributed."""

from __future__ import annotations

import math
import sys
from collections import OrderedDict
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from torch import Tensor


def hash_uniform(count: int, salt: int) -> NDArray[np.float64]:
    """Uniform in (-1, 1), one value per index."""
    x = np.arange(count, dtype=np.uint32) + np.uint32(salt * 0x9E3779B1 & 0xFFFFFFFF)
    x ^= x >> np.uint32(16)
    x *= np.uint32(0x7FEB352D)
    x ^= x >> np.uint32(15)
    x *= np.uint32(0x846CA68B)
    x ^= x >> np.uint32(16)
    return (x + 0.5) * (2 / 2**32) - 1


def filled_state(shapes: dict[str, tuple[int, ...]]) -> dict[str, Tensor]:
    """A float32 value for every parameter: a hash of its place, scaled by the fan-in.

    A hash, not a ramp: matrices of a ramp have rank two and hide transposed axes.
    """
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


def write_lightning_file(path: Path, state: dict[str, Tensor]) -> Path:
    """A checkpoint with the entries that Lightning writes around the weights.

    The training settings are of a class whose package is neither needed nor there when reading.
    """
    import torch

    with _settings_class() as settings:
        config = settings(seed=0, model=settings(width=8))
        config.__dict__["__deprecated_keys__"] = {"old"}
        torch.save(
            {
                "epoch": 3,
                "global_step": 1000,
                "pytorch-lightning_version": "2.2.0",
                "state_dict": OrderedDict(state),
                "loops": {"fit_loop": {"state_dict": {}}},
                "callbacks": {},
                "optimizer_states": [{"state": {0: {"exp_avg": torch.zeros(4)}}}],
                "lr_schedulers": [],
                "hparams_name": "kwargs",
                "hyper_parameters": {"cfg": config},
            },
            path,
        )
    return path


@contextmanager
def _settings_class() -> Iterator[type]:
    names = ("yacs", "yacs.config")
    before = {name: sys.modules.get(name) for name in names}
    package, module = (ModuleType(name) for name in names)
    settings = type("CfgNode", (dict,), {"__module__": "yacs.config"})
    module.CfgNode = settings  # type: ignore[attr-defined]
    sys.modules |= {"yacs": package, "yacs.config": module}
    try:
        yield settings
    finally:
        for name, known in before.items():
            if known is None:
                del sys.modules[name]
            else:
                sys.modules[name] = known
