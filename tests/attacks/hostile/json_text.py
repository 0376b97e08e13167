"""The JSON chunk as text, against parsers."""

from __future__ import annotations

from partuv_contract.errors import LimitError, MalformedGlbError

from tests.attacks.hostile.catalogue import attack
from tests.support.glb_builder import pack


@attack(LimitError)
def million_brackets():
    """A million nested arrays, to exhaust the stack of a recursive parser."""
    return pack(b'{"a":' + b"[" * 1_000_000 + b"]" * 1_000_000 + b"}", None)


@attack(LimitError)
def nesting_behind_an_escaped_quote():
    """Nesting that a scanner overlooks if it takes an escaped quote for the end of a string."""
    return pack(b'{"a":"\\\\","b":' + b"[" * 5000 + b'"\\""' + b"]" * 5000 + b"}", None)


@attack(LimitError)
def ten_million_values():
    """20 MB of text that would become gigabytes of Python objects."""
    return pack(b'{"a":[' + b"0," * 10_000_000 + b"0]}", None)


@attack(MalformedGlbError)
def integer_of_a_million_digits():
    """A number whose conversion takes quadratic time."""
    return pack(b'{"a":' + b"9" * 1_000_000 + b"}", None)


@attack(MalformedGlbError)
def duplicate_keys():
    """Two `meshes`, of which a checker reads the first and a consumer the second."""
    return pack(b'{"asset":{"version":"2.0"},"meshes":[],"meshes":[]}', None)


@attack(MalformedGlbError)
def not_a_number():
    """NaN where JSON has none, to slip past comparisons."""
    return pack(b'{"asset":{"version":"2.0"},"nodes":[{"scale":[NaN,1,1]}]}', None)


@attack(MalformedGlbError)
def invalid_utf8():
    """A byte sequence that decoders replace or drop differently."""
    return pack(b'{"asset":{"version":"2.0","copyright":"\xc0\xaf"}}', None)
