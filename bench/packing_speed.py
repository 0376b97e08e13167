"""How long packing takes for made-up charts: 200 polygons, 200 rectangles, 5,000 polygons.

python -m bench.packing_speed [--threads 2] [--effort 1]
"""

from __future__ import annotations

import argparse
import time

import numpy as np
import partuv_engine
from numpy.typing import NDArray

from bench.packing import Charts

CASES = {"polygons": 200, "rectangles": 200, "many polygons": 5000}


def made_charts(kind: str, count: int, seed: int = 1) -> Charts:
    """Fans around their centres: of 5 to 44 uneven radii, or rectangles of all proportions."""
    random = np.random.default_rng(seed)
    points: list[NDArray[np.float64]] = []
    faces: list[NDArray[np.int32]] = []
    chart: list[NDArray[np.int32]] = []
    base = 0
    for index in range(count):
        size = np.exp(2.5 * random.uniform())
        if kind == "rectangles":
            half = size * np.array([1.0, random.uniform(0.1, 1.0)])
            rim = half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)])
        else:
            corners = int(random.integers(5, 45))
            angle = 2.0 * np.pi * np.arange(corners) / corners
            radius = size * (0.3 + random.uniform(size=corners))
            rim = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        rim_index = base + 1 + np.arange(len(rim))
        fan = np.column_stack([np.full(len(rim), base), rim_index, np.roll(rim_index, -1)])
        points.append(np.vstack([np.zeros((1, 2)), rim]))
        faces.append(fan.astype(np.int32))
        chart.append(np.full(len(rim), index, np.int32))
        base += len(rim) + 1
    part = np.zeros(count, np.int32)
    return Charts(np.vstack(points), np.vstack(faces), np.concatenate(chart), part)


def main() -> None:
    """Pack every case and print a table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--effort", type=float, default=1.0)
    given = parser.parse_args()
    options = partuv_engine.PackOptions()
    options.effort = given.effort
    print("| charts | seconds | processor seconds | efficiency |")
    print("|---|---|---|---|")
    for kind, count in CASES.items():
        charts = made_charts(kind, count)
        context = partuv_engine.Context(given.threads)
        started, worked = time.perf_counter(), time.process_time()
        packed = partuv_engine.pack(charts.uv, charts.faces, charts.chart, options, context)
        seconds, work = time.perf_counter() - started, time.process_time() - worked
        print(
            f"| {count} {kind} | {seconds:.2f} | {work:.2f} | {packed.efficiency:.3f} |", flush=True
        )


if __name__ == "__main__":
    main()
