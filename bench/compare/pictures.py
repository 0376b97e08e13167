"""Atlases side by side, of meshes that are the project's own."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from bench.compare.judge.charts import find_charts


def draw_atlases(path: Path, atlases: Path, meshes: Sequence[str], tools: Sequence[str]) -> None:
    """A row per mesh, a column per tool; charts in colours, the number of charts above."""
    figure = Figure(figsize=(2.1 * len(tools), 2.4 * len(meshes)), layout="constrained", dpi=110)
    grid = figure.subplots(len(meshes), len(tools), squeeze=False)
    for row, mesh in enumerate(meshes):
        for column, tool in enumerate(tools):
            axes = grid[row][column]
            axes.set_axis_off()
            stored = atlases / f"{mesh} {tool}.npz"
            if not stored.exists():
                continue
            with np.load(stored) as atlas:
                uv = atlas["corner_uv"].astype(np.float64)
                charts = find_charts(atlas["positions"], atlas["faces"], uv)
            low, high = uv.min(axis=(0, 1)), uv.max(axis=(0, 1))
            # Neighbouring numbers get far hues: the golden ratio spreads them.
            hues = colormaps["turbo"](np.arange(charts.count) * 0.618034 % 1)
            axes.add_collection(
                PolyCollection(
                    uv,
                    facecolors=hues[charts.of_face],
                    edgecolors="face",
                    linewidths=0.3,
                    antialiased=False,
                )
            )
            side = float((high - low).max())
            axes.set_xlim(low[0], low[0] + side)
            axes.set_ylim(low[1], low[1] + side)
            axes.set_aspect("equal")
            axes.set_title(f"{tool}\n{charts.count} charts", fontsize=8)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, metadata={"Software": None})
