"""What a part prior is: mesh in, grounds for the part tree out.

A prior either gives every face a feature vector, which the engine's Ward clustering turns into a
tree, or it chooses the tree that the engine builds from the geometry alone.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

# Told how much of the prior's work is done, in [0, 1]; may raise to stop it.
Progress = Callable[[float], None]


@dataclass(frozen=True)
class FaceFeatures:
    """Faces of one part have vectors close to each other (Euclidean)."""

    values: NDArray[np.float32]  # F x d


@dataclass(frozen=True)
class GeometricTree:
    """The engine's own tree, from concavity; needs no features."""


@dataclass(frozen=True)
class PriorResult:
    """What the tree is to be built from, and what the job's report says about it."""

    name: str
    version: str
    seconds: float
    grounds: FaceFeatures | GeometricTree

    @property
    def features(self) -> NDArray[np.float32] | None:
        """The vectors of the faces (F x d), if there are any."""
        return self.grounds.values if isinstance(self.grounds, FaceFeatures) else None


class PartPrior(Protocol):
    """Deterministic for a given mesh and version; never changes the mesh."""

    @property
    def name(self) -> str:
        """As in the option `features`."""

    @property
    def version(self) -> str:
        """Changes whenever the result may change; for a network, the hash of its weights."""

    def parts(
        self,
        positions: NDArray[np.float64],
        faces: NDArray[np.int32],
        *,
        threads: int = 1,
        progress: Progress = lambda done: None,
    ) -> PriorResult:
        """Positions V x 3 and finite, faces F x 3."""
