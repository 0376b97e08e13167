import pytest
from partuv_contract.errors import OptionError
from partuv_contract.options import UnwrapOptions


def test_every_option_has_a_default_and_a_meaning():
    assert UnwrapOptions() == UnwrapOptions.parse({})
    for name, field in UnwrapOptions.model_fields.items():
        assert not field.is_required(), name
        assert field.description, name


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("max_area_distortion", 1.0),
        ("max_area_distortion", float("nan")),
        ("min_angular", 1.01),
        ("profile", "best"),
        ("denoise", "on"),
        ("denoise", 0.0),
        ("resolution", 0),
        ("resolution", 3.5),
        ("gutter_texels", -1),
        ("cut_below_efficiency", 1.0),
        ("deadline_s", 0),
        ("speed", 3),
    ],
)
def test_refuses_values_out_of_range_and_names_the_option(name, value):
    with pytest.raises(OptionError) as caught:
        UnwrapOptions.parse({name: value})
    assert caught.value.pointer == f"/{name}"
    assert name in caught.value.message


def test_denoise_is_a_word_or_a_strength():
    assert UnwrapOptions.parse({"denoise": "off"}).denoise == "off"
    assert UnwrapOptions.parse({"denoise": 0.5}).denoise == 0.5
    assert UnwrapOptions.parse({"denoise": "0.5"}).denoise == 0.5


@pytest.mark.parametrize(
    ("values", "option"),
    [
        ({"texel_density": 100, "tiles": 2}, "tiles"),
        ({"texel_density": 100, "group_by_part": "near"}, "group_by_part"),
        ({"texel_density": 100, "cut_below_efficiency": 0.6}, "cut_below_efficiency"),
        ({"tiles": "per_part", "group_by_part": "strict"}, "group_by_part"),
        ({"scope": "mesh", "tiles": 2}, "tiles"),
        ({"scope": "mesh", "texel_density": 3}, "texel_density"),
        ({"scope": "mesh", "texel_weights": ["part:0=2"]}, "texel_weights"),
        ({"mip_levels": 8}, "mip_levels"),
        ({"gutter_texels": 200, "resolution": 256}, "gutter_texels"),
        ({"mode": "repack", "profile": "conformal"}, "profile"),
        ({"mode": "repack", "cut_below_efficiency": 0.0}, "cut_below_efficiency"),
        ({"repack_scale": "keep"}, "repack_scale"),
    ],
    ids=str,
)
def test_refuses_options_that_do_not_go_together(values, option):
    with pytest.raises(OptionError) as caught:
        UnwrapOptions.parse(values)
    assert caught.value.pointer == f"/{option}"
    assert caught.value.message.startswith(f"option {option}: ")


def test_tiles_are_a_number_or_per_part():
    assert UnwrapOptions.parse({"tiles": "4"}).tiles == 4
    assert UnwrapOptions.parse({"tiles": "per_part"}).tiles == "per_part"
    with pytest.raises(OptionError):
        UnwrapOptions.parse({"tiles": 101})
