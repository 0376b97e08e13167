"""The `partuv` command: finds the commands of the installed components and runs one.

A component registers a callable in the entry-point group `partuv.commands`; it takes the arguments
after the command's name and returns the exit code. So this module imports no component.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint, entry_points, version

from partuv_contract.errors import ComponentMissingError

GROUP = "partuv.commands"
EXIT_USAGE = 2
EXIT_COMPONENT_MISSING = 5

Command = Callable[[Sequence[str]], int]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run `partuv COMMAND ...` and return its exit code."""
    argv = list(sys.argv[1:] if arguments is None else arguments)
    registered = {entry.name: entry for entry in entry_points(group=GROUP)}
    if argv[:1] == ["--version"]:
        print(f"partuv {version('partuv-service')}")
        return 0
    if not argv or argv[0] in ("-h", "--help"):
        print(_usage(registered))
        return 0 if argv else EXIT_USAGE
    if argv[0] not in registered:
        print(f"partuv: no command '{argv[0]}'\n\n{_usage(registered)}", file=sys.stderr)
        return EXIT_USAGE
    try:
        command = _load(registered[argv[0]])
    except ComponentMissingError as missing:
        print(f"partuv: {missing.message}", file=sys.stderr)
        return EXIT_COMPONENT_MISSING
    return command(argv[1:])


def _load(entry: EntryPoint) -> Command:
    """The callable behind an entry point; raises `ComponentMissingError` without its component."""
    try:
        command: Command = entry.load()
    except ImportError as failure:
        component = entry.module.partition(".")[0].removeprefix("partuv_")
        raise ComponentMissingError(
            f"'{entry.name}' needs the {component}, which is not installed here ({failure}); "
            f"try: pip install 'partuv-service[{component}]'"
        ) from failure
    return command


def _usage(registered: dict[str, EntryPoint]) -> str:
    lines = ["usage: partuv COMMAND [arguments]", "", "commands:"]
    for name, entry in sorted(registered.items()):
        try:
            meaning = (_load(entry).__doc__ or "").strip().partition("\n")[0]
        except ComponentMissingError:
            meaning = "(not installed here)"
        lines.append(f"  {name:<10} {meaning}")
    lines += ["", "partuv COMMAND --help tells the rest; partuv --version the version."]
    return "\n".join(lines)
