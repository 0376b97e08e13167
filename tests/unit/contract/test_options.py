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
