"""Score the part trees against people's cuts of the Princeton models.

    python bench/parts.py [PARTS_DIR] [--csv FILE]

PARTS_DIR holds one .npz per model (vertices, faces, labels: one row per annotator) and the judge
`rand_index.py`; without it the script says so and ends. The figures are 1 - Rand index in percent,
averaged over the annotators of a model and then over models (Chen, Golovinskiy, Funkhouser 2009).
Thresholds were chosen on the `tuned` half (every other model); `held out` is the other one.
"""

from __future__ import annotations

import argparse
import csv
import importlib.util
import statistics
import sys
import time
from collections import defaultdict
from collections.abc import Iterable
from pathlib import Path
from types import ModuleType

import numpy as np
from partuv_engine import Surface, build_part_tree, cut_tree, cut_tree_auto

DEFAULT_PARTS = Path(__file__).resolve().parents[2] / "shared" / "parts"
COLUMNS = ("people", "given", "auto", "parts")


def load_judge(folder: Path) -> ModuleType:
    spec = importlib.util.spec_from_file_location("rand_index", folder / "rand_index.py")
    assert spec is not None
    assert spec.loader is not None
    judge = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(judge)
    return judge


def score(path: Path, judge: ModuleType) -> dict[str, float]:
    """Errors of one model in percent, the number of parts found and the seconds it took."""
    with np.load(path) as model:
        positions = model["vertices"].astype(np.float64)
        faces = model["faces"].astype(np.int32)
        annotations = model["labels"]
    started = time.perf_counter()
    surface = Surface(positions, faces, canonical=True).denoised(None)
    tree = build_part_tree(surface)
    named = cut_tree_auto(surface, tree)
    seconds = time.perf_counter() - started
    counts = judge.part_counts(annotations)
    given = [
        judge.rand_error(cut_tree(surface, tree, int(count)), annotation)
        for count, annotation in zip(counts, annotations, strict=True)
    ]
    auto = [judge.rand_error(named, annotation) for annotation in annotations]
    return {
        "people": 100 * judge.human_error(annotations),
        "given": 100 * float(np.mean(given)),
        "auto": 100 * float(np.mean(auto)),
        "parts": float(named.max() + 1),
        "seconds": seconds,
    }


def print_row(name: str, rows: Iterable[dict[str, float]]) -> None:
    rows = list(rows)
    means = (statistics.fmean(row[column] for row in rows) for column in COLUMNS)
    print(f"| {name} | {len(rows)} | " + " | ".join(f"{mean:.1f}" for mean in means) + " |")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("parts", nargs="?", type=Path, default=DEFAULT_PARTS)
    parser.add_argument("--csv", type=Path, help="write one row per model")
    arguments = parser.parse_args()
    models = sorted(arguments.parts.glob("*.npz"))
    if not models:
        sys.exit(f"skipped: no models in {arguments.parts}")
    judge = load_judge(arguments.parts)
    rows = {path.stem: score(path, judge) for path in models}
    if arguments.csv:
        with arguments.csv.open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(["model", *COLUMNS, "seconds"])
            writer.writerows([name, *row.values()] for name, row in rows.items())
    categories = defaultdict(list)
    for name, row in rows.items():
        categories[name.rsplit("_", 1)[-1]].append(row)
    print(f"| category | models | {' | '.join(COLUMNS)} |")
    print("| --- |" + " ---: |" * (1 + len(COLUMNS)))
    for category in sorted(categories):
        print_row(category, categories[category])
    scores = list(rows.values())
    print_row("tuned", scores[::2])
    print_row("held out", scores[1::2])
    print_row("**all**", scores)
    print(f"\n{sum(row['seconds'] for row in scores):.1f} s for all models")


if __name__ == "__main__":
    main()
