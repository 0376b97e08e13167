"""From the option `features` to the prior that runs, decided once at start."""

from dataclasses import dataclass
from importlib.util import find_spec

from partuv_worker.features.errors import FeaturesError
from partuv_worker.features.geometric import GeometricPrior
from partuv_worker.features.normals import NormalsPrior
from partuv_worker.features.prior import PartPrior
from partuv_worker.features.settings import FeaturesChoice, PartFieldSettings


@dataclass(frozen=True)
class ChosenPrior:
    """`note` tells the job's report when `auto` had to do without the learned features."""

    prior: PartPrior
    note: str | None = None


def choose_prior(choice: FeaturesChoice, settings: PartFieldSettings | None) -> ChosenPrior:
    """The prior for a choice; loads the weights if it needs them.

    `settings` is None where no checkpoint is configured. Raises `FeaturesError` where `partfield`
    was asked for and can't run; `auto` falls back to the geometric tree instead.
    """
    if choice == "geometric":
        return ChosenPrior(GeometricPrior())
    if choice == "normals":
        return ChosenPrior(NormalsPrior())
    try:
        return ChosenPrior(_partfield(settings))
    except FeaturesError as failure:
        if choice == "partfield":
            raise
        return ChosenPrior(
            GeometricPrior(), f"features: auto used the geometric tree: {failure.message}"
        )


def _partfield(settings: PartFieldSettings | None) -> PartPrior:
    if settings is None:
        raise FeaturesError("no PartField checkpoint is configured")
    missing = [name for name in ("torch", "safetensors") if find_spec(name) is None]
    if missing:
        raise FeaturesError(
            f"PartField needs {' and '.join(missing)}; try: pip install 'partuv-service[partfield]'"
        )
    # Here and not above: torch takes seconds and hundreds of megabytes to import.
    from partuv_worker.features.partfield.prior import PartFieldPrior

    return PartFieldPrior(settings)
