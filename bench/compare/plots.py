"""The results as pictures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from statistics import fmean
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from bench.compare.summary import ByMesh, finished, mean_ratio

_COLORS = (
    "#d1495b", "#e08e45", "#2e4057", "#1b998b", "#7d5ba6", "#b39ddb", "#5b8c5a", "#8d99ae",
)  # fmt: skip


def _color(number: int) -> str:
    return _COLORS[number % len(_COLORS)]


def plot_charts(path: Path, tools: Sequence[str], results: Mapping[str, ByMesh], base: str) -> None:
    """Charts, relative to ours, against the angular score: dots are meshes, discs the means."""
    ours = finished(results[base])
    x, y = "charts, relative to PartUV service (left is better)", "angular score (up is better)"
    with _plotted(path, x, y) as axes:
        for number, tool in enumerate(tools):
            runs = finished(results[tool])
            shared = sorted(runs.keys() & ours.keys())
            mean = mean_ratio(runs, ours, lambda run: run.figures.charts)
            if mean is None:
                continue
            ratios = [runs[mesh].figures.charts / ours[mesh].figures.charts for mesh in shared]
            angular = [runs[mesh].figures.angular_mean for mesh in shared]
            color = _color(number)
            axes.scatter(ratios, angular, s=9, alpha=0.35, color=color, linewidths=0)
            axes.scatter([mean], [fmean(angular)], s=80, color=color, label=tool, zorder=3)


def plot_seconds(path: Path, tools: Sequence[str], results: Mapping[str, ByMesh]) -> None:
    """Seconds against faces, both logarithmic."""
    with _plotted(path, "faces", "seconds") as axes:
        axes.set_yscale("log")
        for number, tool in enumerate(tools):
            runs = finished(results[tool])
            if not runs:
                continue
            points = sorted((results[tool][mesh].faces, run.seconds) for mesh, run in runs.items())
            faces, seconds = zip(*points, strict=True)
            axes.scatter(faces, seconds, s=25, alpha=0.8, color=_color(number), label=tool)


@contextmanager
def _plotted(path: Path, x: str, y: str) -> Iterator[Any]:
    """Axes to draw tools on, x logarithmic, that are then written with a legend beside them."""
    figure = Figure(figsize=(8.5, 4.2), layout="constrained")
    axes = figure.subplots()
    axes.set_xscale("log")
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(alpha=0.2)
    yield axes
    figure.legend(loc="outside right upper", fontsize=8)
    path.parent.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context({"svg.hashsalt": "partuv", "svg.fonttype": "none"}):
        figure.savefig(path, metadata={"Date": None})
