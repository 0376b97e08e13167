from dataclasses import replace

import numpy as np
import pytest

from bench.compare.judge import Figures
from bench.compare.meshes import OWN_SET
from bench.compare.results import Result, Results
from bench.compare.tools import ABLATIONS, OURS, PEERS
from tests.support.uv import separate_faces

pytest.importorskip("matplotlib", reason="only the bench has matplotlib")


def test_the_page_shows_every_set_and_its_pictures(tmp_path):
    from bench.compare.page import write_page

    figures = Figures(4, 1, 1.2, 1.1, 0.96, 0.95, 3.0, 0, 0, True, 4.0, 0.6)
    ours = Result("robot", "d", 100, OURS.name, "ours 1", "ok", 60, 2.0, 3.0, 50, figures)
    cache = tmp_path / "cache"
    for name in (OWN_SET, "others"):
        results = Results(cache / "results" / f"{name}.jsonl")
        results.add(ours)
        results.add(replace(ours, tool=PEERS[0].name, figures=replace(figures, charts=12)))
        results.add(replace(ours, tool=PEERS[1].name, status="timeout", figures=None))
        for tool in ABLATIONS:
            results.add(replace(ours, tool=tool.name))
    (cache / "atlases").mkdir()
    np.savez(
        cache / "atlases" / f"robot {OURS.name}.npz",
        positions=np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]),
        faces=np.array([[0, 1, 2]]),
        corner_uv=separate_faces(1),
    )
    page = tmp_path / "docs" / "benchmarks.md"
    write_page(page, cache)
    text = page.read_text()
    assert text.index(f"## {OWN_SET.capitalize()}") < text.index("## Others")
    assert f"| {PEERS[0].name} | 1 of 1 | 12 | 3.00 |" in text
    assert f"| {PEERS[1].name} | time-out |" in text
    assert text.count(f"| {ABLATIONS[-1].name} | 1 of 1 |") == 2
    shown = {part.partition(")")[0] for part in text.split("](")[1:]}
    written = {str(path.relative_to(page.parent)) for path in page.parent.rglob("*.[sp][vn]g")}
    assert shown == written
    assert len(written) == 5
