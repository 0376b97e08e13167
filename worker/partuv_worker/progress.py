"""How far a run of the pipeline is."""

from __future__ import annotations

from typing import NamedTuple


class Progress(NamedTuple):
    """For a bar: a fraction that never falls, and a word for what is done."""

    fraction: float  # 0 to 1
    stage: str
