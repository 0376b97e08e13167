from importlib.metadata import EntryPoint

import pytest
from partuv_contract import commands


@pytest.fixture
def registered(monkeypatch):
    """Replace the installed commands by the given ones."""

    def register(**targets):
        found = [EntryPoint(name, target, commands.GROUP) for name, target in targets.items()]
        monkeypatch.setattr(commands, "entry_points", lambda group: found)

    return register


def test_runs_the_command_with_the_arguments_after_its_name(registered, capsys):
    registered(show="builtins:print")
    assert commands.main(["show", "-x", "file"]) is None
    assert capsys.readouterr().out == "['-x', 'file']\n"


def test_a_missing_component_is_named_with_the_way_to_get_it(registered, capsys):
    registered(serve="partuv_nowhere.cli:command")
    assert commands.main(["serve"]) == commands.EXIT_COMPONENT_MISSING
    told = capsys.readouterr().err
    assert "'serve' needs the nowhere" in told
    assert "pip install 'partuv-service[nowhere]'" in told


def test_help_lists_commands_even_if_their_component_is_missing(registered, capsys):
    registered(serve="partuv_nowhere.cli:command", count="builtins:len")
    assert commands.main(["--help"]) == 0
    told = capsys.readouterr().out
    assert "(not installed here)" in told
    assert "Return the number of items in a container." in told


def test_an_unknown_command_is_a_usage_error(registered, capsys):
    registered(count="builtins:len")
    assert commands.main(["fly"]) == commands.EXIT_USAGE
    assert "no command 'fly'" in capsys.readouterr().err
    assert commands.main([]) == commands.EXIT_USAGE
