"""Checked steps through untrusted JSON: every complaint names where it is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, NoReturn

from partuv_contract.errors import MalformedGlbError

LARGEST_INTEGER = (1 << 53) - 1


@dataclass(frozen=True, slots=True)
class Cursor:
    """A JSON value and the pointer (RFC 6901) that leads to it."""

    value: Any
    pointer: str

    def fail(self, message: str) -> NoReturn:
        """Refuse this value."""
        raise MalformedGlbError(message, pointer=self.pointer)

    def get(self, key: str) -> Cursor | None:
        """The member `key` of this object, or None if it has none."""
        if not isinstance(self.value, dict):
            self.fail("not an object")
        if key not in self.value:
            return None
        return Cursor(
            self.value[key], f"{self.pointer}/{key.replace('~', '~0').replace('/', '~1')}"
        )

    def need(self, key: str) -> Cursor:
        """The member `key` of this object, which must be there."""
        found = self.get(key)
        if found is None:
            self.fail(f"'{key}' is missing")
        return found

    def items(self) -> Iterator[tuple[str, Cursor]]:
        """All members of this object."""
        if not isinstance(self.value, dict):
            self.fail("not an object")
        for key in self.value:
            yield key, self.need(key)

    def elements(self, key: str) -> list[Cursor]:
        """The elements of the array `key` of this object; none if it is missing."""
        found = self._array(key)
        return [Cursor(value, f"{found.pointer}/{i}") for i, value in enumerate(found.value)]

    def element(self, key: str, index: int) -> Cursor:
        """One element of the array `key` of this object, which must exist."""
        found = self._array(key)
        return Cursor(found.value[index], f"{found.pointer}/{index}")

    def length(self, key: str) -> int:
        """How many elements the array `key` of this object has; none if it is missing."""
        return len(self._array(key).value)

    def _array(self, key: str) -> Cursor:
        found = self.get(key) or Cursor([], f"{self.pointer}/{key}")
        if not isinstance(found.value, list):
            found.fail("not an array")
        return found

    def as_integer(self, minimum: int = 0, maximum: int = LARGEST_INTEGER) -> int:
        """This value as an integer in a range."""
        value = self.value
        if isinstance(value, float) and value.is_integer():  # JSON knows no integers: 3.0 is 3
            value = int(value)
        if not isinstance(value, int) or isinstance(value, bool):
            self.fail("not an integer")
        if not minimum <= value <= maximum:
            self.fail(f"{value} is out of range, {minimum} to {maximum} are allowed")
        return value

    def integer(
        self, key: str, default: int, minimum: int = 0, maximum: int = LARGEST_INTEGER
    ) -> int:
        """The member `key` as an integer in a range, or the default."""
        found = self.get(key)
        return default if found is None else found.as_integer(minimum, maximum)

    def index(self, key: str, length: int, what: str) -> int | None:
        """The member `key` as an index into an array of `length` things, or None."""
        found = self.get(key)
        return None if found is None else found.as_index(length, what)

    def as_index(self, length: int, what: str) -> int:
        """This value as an index into an array of `length` things."""
        value = self.as_integer(-LARGEST_INTEGER)
        if not 0 <= value < length:
            self.fail(f"{what} {value} does not exist, there are {length}")
        return value

    def as_text(self) -> str:
        """This value as a string."""
        if not isinstance(self.value, str):
            self.fail("not a string")
        return self.value

    def flag(self, key: str) -> bool:
        """The member `key` as a boolean, false if it is missing."""
        found = self.get(key)
        if found is None:
            return False
        if not isinstance(found.value, bool):
            found.fail("not a boolean")
        return found.value

    def numbers(self, key: str, length: int) -> list[float] | None:
        """The member `key` as a list of `length` finite numbers, or None."""
        found = self.get(key)
        if found is None:
            return None
        values = found.value
        if not isinstance(values, list) or len(values) != length:
            found.fail(f"not a list of {length} numbers")
        for value in values:
            if isinstance(value, bool) or not isinstance(value, int | float):
                found.fail(f"not a list of {length} numbers")
            if not math.isfinite(value):
                found.fail("not finite")
        return [float(value) for value in values]
