"""An operation on the store: a Lua script with its arguments, and how to read its answer.

Operations are plain values. `Store` runs them and waits, `AsyncStore` runs them on an event loop,
so what an operation means is written once.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any, Generic, TypeVar

Argument = str | bytes | int | float
T = TypeVar("T")


@dataclass(frozen=True)
class Operation(Generic[T]):
    """One atomic step; `parse` turns the reply of Redis into the operation's result."""

    script: str
    arguments: tuple[Argument, ...]
    parse: Callable[[Any], T]


@cache
def script_source(name: str) -> str:
    """The Lua source of a script, the shared part in front."""
    folder = files("partuv_store") / "scripts"
    return (folder / "common.lua").read_text() + (folder / f"{name}.lua").read_text()
