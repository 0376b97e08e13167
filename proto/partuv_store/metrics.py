"""Counters that live in Redis, so that they outlast the processes that count.

A histogram `name` is kept as the fields `name:sum`, `name:count` and `name:le:BOUND`, one
observation in the first bucket that holds it; whoever reads them adds up.
"""

from __future__ import annotations

# The scripts observe waiting and total times with the same bounds (`SECONDS` in common.lua).
SECONDS = (0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0, 30.0, 60.0, 120.0, 300.0, 600.0)
FACES = (100.0, 1e3, 5e3, 1e4, 2e4, 5e4, 1e5, 2e5, 5e5, 1e6)
CHARTS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0)
RATIOS = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0)


def observation(name: str, value: float, bounds: tuple[float, ...]) -> dict[str, float]:
    """The increments that one observed value makes."""
    fields = {f"{name}:sum": value, f"{name}:count": 1.0}
    for bound in bounds:
        if value <= bound:
            fields[f"{name}:le:{bound:g}"] = 1.0
            break
    return fields


def buckets(
    metrics: dict[str, float], name: str, bounds: tuple[float, ...]
) -> tuple[list[tuple[str, float]], float]:
    """Cumulative buckets, up to +Inf, and the sum of what was observed."""
    total = 0.0
    cumulative: list[tuple[str, float]] = []
    for bound in bounds:
        total += metrics.get(f"{name}:le:{bound:g}", 0.0)
        cumulative.append((f"{bound:g}", total))
    cumulative.append(("+Inf", metrics.get(f"{name}:count", 0.0)))
    return cumulative, metrics.get(f"{name}:sum", 0.0)
