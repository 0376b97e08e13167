"""The options of a job as the engine gets them."""

import pytest
from partuv_contract.options import UnwrapOptions
from partuv_engine import Options
from partuv_worker.engine_call import engine_options


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("profile", ("balanced", "conformal")),
        ("flattening", ("abf", "lscm")),
        ("quality", ("fast", "standard", "best")),
        ("group_by_part", ("none", "near", "strict")),
    ],
)
def test_words_reach_the_engine(name, words):
    for word in words:
        assert getattr(engine_options(UnwrapOptions.parse({name: word})), name).name == word


def test_the_efficiency_to_cut_for_reaches_the_engine():
    assert engine_options(UnwrapOptions()).cut_below_efficiency == Options().cut_below_efficiency
    options = UnwrapOptions.parse({"cut_below_efficiency": 0.6})
    assert engine_options(options).cut_below_efficiency == 0.6
