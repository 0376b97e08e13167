"""Part priors: where the worker's part tree comes from. Importing this never imports torch."""

from partuv_worker.features.geometric import GeometricPrior
from partuv_worker.features.normals import NormalsPrior
from partuv_worker.features.prior import (
    FaceFeatures,
    GeometricTree,
    PartPrior,
    PriorResult,
    Progress,
)
from partuv_worker.features.priors import ChosenPrior, FeaturesChoice, Priors
from partuv_worker.partfield_settings import PartFieldSettings

__all__ = [
    "ChosenPrior",
    "FaceFeatures",
    "FeaturesChoice",
    "GeometricPrior",
    "GeometricTree",
    "NormalsPrior",
    "PartFieldSettings",
    "PartPrior",
    "PriorResult",
    "Priors",
    "Progress",
]
