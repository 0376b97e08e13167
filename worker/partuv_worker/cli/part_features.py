"""Command-line flags for the learned part features: where the weights lie and how they run."""

from __future__ import annotations

import argparse
from dataclasses import fields
from pathlib import Path
from typing import Any

from partuv_worker.partfield_settings import PartFieldSettings

_DEFAULTS = {field.name: field.default for field in fields(PartFieldSettings)}


class _CheckpointFlag(argparse.Action):
    """Weights are given to be used: `--features` before or after may still say otherwise."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        namespace.checkpoint = values
        namespace.features = namespace.features or "auto"


def add_feature_flags(parser: argparse.ArgumentParser) -> None:
    """Flags of this machine, not of the asset: they are no options of a job."""
    group = parser.add_argument_group("learned part features (PartField)")
    group.add_argument(
        "--checkpoint",
        type=Path,
        action=_CheckpointFlag,
        help="the network's weights, .ckpt or .safetensors; without --features it means auto",
    )
    group.add_argument(
        "--device", choices=("cpu", "cuda"), default=_DEFAULTS["device"], help="where it runs"
    )
    group.add_argument(
        "--precision",
        choices=("float32", "half"),
        default=_DEFAULTS["precision"],
        help="half is faster and changes features by about 1%% (default: %(default)s)",
    )
    group.add_argument(
        "--points",
        type=_points,
        default=_DEFAULTS["points"],
        help="surface points that the network sees (default: %(default)s)",
    )


def feature_settings(parsed: argparse.Namespace) -> PartFieldSettings | None:
    """The settings that the flags ask for, none without a checkpoint."""
    if parsed.checkpoint is None:
        return None
    return PartFieldSettings(
        parsed.checkpoint, device=parsed.device, precision=parsed.precision, points=parsed.points
    )


def _points(text: str) -> int:
    """A number of points."""
    number = int(text)
    if not 1000 <= number <= 10_000_000:
        raise argparse.ArgumentTypeError("must be between 1000 and 10000000")
    return number
