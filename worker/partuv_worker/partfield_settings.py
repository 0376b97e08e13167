"""How this installation runs the part priors; the same for every job."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

Frame = Literal["partfield", "partuv"]


@dataclass(frozen=True)
class PartFieldSettings:
    """Where the weights lie and how exactly the network is run."""

    checkpoint: Path
    device: Literal["cpu", "cuda"] = "cpu"
    # half: convolutions and matrix products in 16 bits (float16 on cuda, bfloat16 on the cpu),
    # norms, means and look-ups in 32; features change by about 1 %.
    precision: Literal["float32", "half"] = "float32"
    frame: Frame = "partfield"  # where the network sees the mesh, see `normalised_positions`
    points: int = 100_000  # on the surface, the network's input
    points_per_face: int = 10  # whose mean is the face's feature
    variance_lost: float = 1e-3  # share of the features' variance given up for fewer dimensions
    seed: int = 42

    def to_json(self) -> str:
        """For the command line of a process that runs with these settings."""
        return json.dumps(asdict(self), default=str)

    @classmethod
    def from_json(cls, text: str) -> PartFieldSettings:
        """The settings that `to_json` wrote."""
        values = json.loads(text)
        return cls(**values | {"checkpoint": Path(values["checkpoint"])})
