"""From the option `features` to the prior that runs."""

from importlib.util import find_spec
from typing import Literal, NamedTuple

from partuv_contract.errors import FeaturesError

from partuv_worker.features.geometric import GeometricPrior
from partuv_worker.features.normals import NormalsPrior
from partuv_worker.features.prior import PartPrior
from partuv_worker.partfield_settings import PartFieldSettings

FeaturesChoice = Literal["geometric", "partfield", "normals", "auto"]


class ChosenPrior(NamedTuple):
    """`notes` tell the job's report when `auto` had to do without the learned features."""

    prior: PartPrior
    notes: tuple[str, ...] = ()


class Priors:
    """The priors of one process; weights are loaded when first asked for, and only once.

    `settings` is None where no checkpoint is configured.
    """

    def __init__(self, settings: PartFieldSettings | None = None) -> None:
        self._settings = settings
        self._partfield: PartPrior | FeaturesError | None = None

    def choose(self, choice: FeaturesChoice) -> ChosenPrior:
        """The prior for a choice.

        Raises `FeaturesError` where `partfield` was asked for and can't run; `auto` falls back to
        the geometric tree instead.
        """
        if choice == "geometric":
            return ChosenPrior(GeometricPrior())
        if choice == "normals":
            return ChosenPrior(NormalsPrior())
        try:
            return ChosenPrior(self.partfield())
        except FeaturesError as failure:
            if choice == "partfield":
                raise
            note = f"features: auto used the geometric tree: {failure.message}"
            return ChosenPrior(GeometricPrior(), (note,))

    def partfield(self) -> PartPrior:
        """The learned prior; raises `FeaturesError`, the same at every call, if there is none."""
        if self._partfield is None:
            try:
                self._partfield = _load(self._settings)
            except FeaturesError as failure:
                self._partfield = failure
        if isinstance(self._partfield, FeaturesError):
            raise self._partfield.with_traceback(None)
        return self._partfield


def _load(settings: PartFieldSettings | None) -> PartPrior:
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
