"""Texel weights as an option writes them: `material:NAME=2`, `part:3=0.5`."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

LEAST, MOST = 0.01, 100.0


@dataclass
class TexelWeights:
    """Texels along a unit of length, relative to everything that is not named."""

    material: dict[str, float] = field(default_factory=dict)
    part: dict[int, float] = field(default_factory=dict)


def read_texel_weights(items: Sequence[str]) -> TexelWeights:
    """The weights of all items; raises a `ValueError` that says what is wrong with which."""
    weights = TexelWeights()
    for item in items:
        target, equals, number = item.rpartition("=")
        kind, colon, name = target.partition(":")
        if not equals or not colon or kind not in ("material", "part") or not name:
            raise ValueError(f"{item!r} is neither material:NAME=WEIGHT nor part:NUMBER=WEIGHT")
        weight = _number(number)
        if weight is None or not LEAST <= weight <= MOST:
            raise ValueError(f"the weight of {item!r} is no number from {LEAST:g} to {MOST:g}")
        if kind == "material":
            if name in weights.material:
                raise ValueError(f"material {name!r} is given twice")
            weights.material[name] = weight
            continue
        if not (name.isascii() and name.isdecimal() and len(name) < 10):
            raise ValueError(f"{item!r}: parts have numbers, as in the report")
        if int(name) in weights.part:
            raise ValueError(f"part {int(name)} is given twice")
        weights.part[int(name)] = weight
    return weights


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None
