"""Texel weights as text: what is read, and what is said of the rest."""

import pytest
from partuv_contract.errors import OptionError
from partuv_contract.options import UnwrapOptions


def test_materials_and_parts_are_read():
    items = ["material:Skin=2", "material:a:b=c=0.5", "part:3=1.5", "part:0=100"]
    weights = UnwrapOptions.parse({"texel_weights": items}).weights()
    assert weights.material == {"Skin": 2.0, "a:b=c": 0.5}
    assert weights.part == {3: 1.5, 0: 100.0}


@pytest.mark.parametrize(
    ("items", "named"),
    [
        (["Skin=2"], "'Skin=2'"),
        (["mesh:Skin=2"], "material:NAME=WEIGHT"),
        (["material:=2"], "material:=2"),
        (["material:Skin"], "material:Skin"),
        (["material:Skin=0"], "0.01"),
        (["material:Skin=nan"], "0.01"),
        (["material:Skin=lots"], "lots"),
        (["part:head=2"], "part:head=2"),
        (["part:-1=2"], "part:-1=2"),
        (["material:Skin=2", "material:Skin=3"], "'Skin' is given twice"),
        (["part:1=2", "part:01=3"], "part 1 is given twice"),
    ],
)
def test_what_makes_no_sense_is_named(items, named):
    with pytest.raises(OptionError, match="texel_weights") as refused:
        UnwrapOptions.parse({"texel_weights": items})
    assert named in str(refused.value)
    assert refused.value.pointer == "/texel_weights"
