"""What the results of a set say about a tool, relative to another one on the same meshes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from bench.compare.judge import Figures
from bench.compare.results import Result

ByMesh = Mapping[str, Result]


@dataclass(frozen=True)
class Finished:
    """A run that gave an atlas."""

    figures: Figures
    seconds: float
    cpu_seconds: float
    peak_rss_mb: float


def by_tool(results: Iterable[Result]) -> dict[str, dict[str, Result]]:
    """Results by tool, then by mesh."""
    table: dict[str, dict[str, Result]] = {}
    for result in results:
        table.setdefault(result.tool, {})[result.mesh] = result
    return table


def finished(results: ByMesh) -> dict[str, Finished]:
    """The runs that gave an atlas, by mesh."""
    return {
        mesh: Finished(result.figures, result.seconds, result.cpu_seconds, result.peak_rss_mb)
        for mesh, result in results.items()
        if result.figures is not None
        and result.seconds is not None
        and result.cpu_seconds is not None
        and result.peak_rss_mb is not None
    }


def mean_ratio(
    runs: Mapping[str, Finished],
    others: Mapping[str, Finished],
    figure: Callable[[Finished], float],
) -> float | None:
    """Geometric mean of figure / other's figure over the meshes where both have one above zero."""
    logs = [
        math.log(figure(runs[mesh]) / figure(others[mesh]))
        for mesh in runs.keys() & others.keys()
        if figure(runs[mesh]) > 0 and figure(others[mesh]) > 0
    ]
    return math.exp(math.fsum(logs) / len(logs)) if logs else None


def sum_ratio(
    runs: Mapping[str, Finished],
    others: Mapping[str, Finished],
    figure: Callable[[Finished], float],
) -> float | None:
    """Sum of a figure over the other's sum, over the meshes that both finished."""
    both = sorted(runs.keys() & others.keys())
    base = math.fsum(figure(others[mesh]) for mesh in both)
    return math.fsum(figure(runs[mesh]) for mesh in both) / base if base > 0 else None
