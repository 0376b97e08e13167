"""The parts stay as near to people's as docs/parts.md says."""

from statistics import fmean

import pytest

from bench.parts import DEFAULT_PARTS, load_judge, score


def test_parts_are_as_near_to_peoples_as_documented() -> None:
    models = sorted(DEFAULT_PARTS.glob("*.npz"))
    if not models:
        pytest.skip("the models that people cut are not here")
    judge = load_judge(DEFAULT_PARTS)
    rows = [score(model, judge) for model in models]
    assert len(rows) == 228
    assert fmean(row["given"] for row in rows) <= 10.5
    assert fmean(row["auto"] for row in rows) <= 12.0
    assert fmean(row["people"] for row in rows) == pytest.approx(10.5, abs=0.05)
