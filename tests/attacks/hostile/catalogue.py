"""The list that the hostile files are entered into."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from partuv_contract.errors import PartuvError


@dataclass(frozen=True)
class Attack:
    """A file, what it tries, and how it must be refused."""

    tries: str
    error: type[PartuvError]
    build: Callable[[], bytes]


ATTACKS: dict[str, Attack] = {}


def attack(error: type[PartuvError]):
    """Register a builder of bytes; its docstring says what the file tries."""

    def register(build: Callable[[], bytes]) -> Callable[[], bytes]:
        ATTACKS[build.__name__] = Attack(build.__doc__ or "", error, build)
        return build

    return register
