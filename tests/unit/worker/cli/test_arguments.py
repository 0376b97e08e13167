import argparse

import pytest
from partuv_contract.errors import OptionError
from partuv_contract.options import UnwrapOptions
from partuv_worker.cli.arguments import add_option_flags, options_from
from partuv_worker.cli.part_features import add_feature_flags


def parse(*arguments):
    parser = argparse.ArgumentParser()
    add_option_flags(parser)
    add_feature_flags(parser)
    return options_from(parser.parse_args(arguments))


def test_without_flags_the_defaults_of_the_contract_hold():
    assert parse() == UnwrapOptions()


def test_every_option_has_a_flag_and_two_have_short_names():
    options = parse("--threshold", "1.5", "--gutter", "2", "--denoise", "off", "--deadline-s", "9")
    assert options.max_area_distortion == 1.5
    assert options.gutter_texels == 2
    assert options.denoise == "off"
    assert options.deadline_s == 9
    parser = argparse.ArgumentParser()
    add_option_flags(parser)
    for name in UnwrapOptions.model_fields:
        assert f"--{name.replace('_', '-')}" in parser.format_help()


def test_values_out_of_range_are_refused_by_the_contract():
    with pytest.raises(OptionError) as caught:
        parse("--threshold", "0.5")
    assert caught.value.pointer == "/max_area_distortion"


def test_a_list_is_given_by_repeating_its_flag():
    assert parse("--only", "Body", "--only", "Head, left").only == ("Body", "Head, left")


def test_a_checkpoint_asks_for_learned_features_unless_others_are_named():
    assert parse("--checkpoint", "weights.ckpt").features == "auto"
    named, weights = ("--features", "normals"), ("--checkpoint", "weights.ckpt")
    assert parse(*named, *weights).features == "normals"
    assert parse(*weights, *named).features == "normals"
