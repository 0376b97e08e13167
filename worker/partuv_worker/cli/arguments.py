"""Command-line flags made from the one definition of the options."""

from __future__ import annotations

import argparse
import os
from collections.abc import Collection
from typing import Any, Literal, get_args, get_origin

from partuv_contract.options import UnwrapOptions


def add_option_flags(
    parser: argparse.ArgumentParser, names: Collection[str] = UnwrapOptions.model_fields.keys()
) -> None:
    """One flag for each of these options, with its short name if it has one."""
    group = parser.add_argument_group("options")
    for name, field in UnwrapOptions.model_fields.items():
        if name not in names:
            continue
        extra: dict[str, Any] = (
            field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        )
        flags = [f"--{name.replace('_', '-')}"]
        if "alias" in extra:
            flags.append(f"--{extra['alias']}")
        unit = f", in {extra['unit']}" if extra.get("unit") in ("texels", "seconds") else ""
        default = field.default if field.default not in (None, ()) else "none"
        is_list = get_origin(field.annotation) is tuple
        group.add_argument(
            *flags,
            dest=name,
            default=None,
            action="append" if is_list else "store",
            metavar="NAME" if is_list else _values(field.annotation),
            help=f"{field.description}{unit} (default: {default})".replace("%", "%%"),
        )


def _values(annotation: Any) -> str:
    """What may be given, in a word: the choices, or NUMBER."""
    if get_origin(annotation) is Literal:
        return "|".join(get_args(annotation))
    if annotation is bool:
        return "true|false"
    words = [_values(part) for part in get_args(annotation) if get_origin(part) is Literal]
    return "|".join([*words, "NUMBER"])


def options_from(parsed: argparse.Namespace) -> UnwrapOptions:
    """The options that were given; raises `OptionError` for the first bad one."""
    given = {name: getattr(parsed, name, None) for name in UnwrapOptions.model_fields}
    return UnwrapOptions.parse({name: text for name, text in given.items() if text is not None})


def add_running_flags(parser: argparse.ArgumentParser) -> None:
    """How a command works and talks, whatever it does."""
    parser.add_argument(
        "--threads",
        type=_threads,
        default=len(os.sched_getaffinity(0)),
        help="how many to use (default: %(default)s)",
    )
    parser.add_argument("-q", "--quiet", action="store_true", help="say nothing unless it fails")


def _threads(text: str) -> int:
    """A number of threads."""
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("must be at least 1")
    return number
