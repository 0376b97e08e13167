"""What a finished job adds to the service's metrics."""

from __future__ import annotations

from typing import Any

from partuv_store.metrics import CHARTS, FACES, RATIOS, SECONDS, observation


def metrics_of(report: dict[str, Any]) -> dict[str, float]:
    """The increments of one report."""
    increments = observation("faces", report["faces"], FACES)
    increments |= observation("charts", report["chart_count"], CHARTS)
    increments |= observation("utilisation", report["packing_efficiency"], RATIOS)
    for stage, seconds in report["seconds"].items():
        increments |= observation(f"stage_seconds:{stage}", seconds, SECONDS)
    return increments
