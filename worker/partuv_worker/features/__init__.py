"""Part priors: where the worker's part tree comes from. Importing this never imports torch."""

from partuv_worker.features.choose import ChosenPrior, choose_prior
from partuv_worker.features.errors import CheckpointError, FeaturesError
from partuv_worker.features.geometric import GeometricPrior
from partuv_worker.features.normals import NormalsPrior
from partuv_worker.features.prior import (
    FaceFeatures,
    GeometricTree,
    PartPrior,
    PriorResult,
    Progress,
)
from partuv_worker.features.settings import FeaturesChoice, PartFieldSettings

__all__ = [
    "CheckpointError",
    "ChosenPrior",
    "FaceFeatures",
    "FeaturesChoice",
    "FeaturesError",
    "GeometricPrior",
    "GeometricTree",
    "NormalsPrior",
    "PartFieldSettings",
    "PartPrior",
    "PriorResult",
    "Progress",
    "choose_prior",
]
