"""The JSON chunk, read strictly: hostile text is refused before a parser sees it."""

from __future__ import annotations

import json
import re
from typing import Any, NoReturn

import numpy as np
from partuv_contract.errors import LimitError, MalformedGlbError

from partuv_worker.glb.container import Chunk
from partuv_worker.glb.limits import Limits

_LONGEST_INTEGER = 20  # digits; more than any index or size can have
_LONE_SURROGATE = re.compile("[\ud800-\udfff]")


def parse_json(chunk: Chunk, limits: Limits) -> dict[str, Any]:
    """Parse the document; refuses depth, size, duplicate keys, NaN and numbers without end."""
    _check_shape(np.frombuffer(chunk.content, np.uint8), chunk.offset, limits)
    try:
        text = str(chunk.content, "utf-8")
    except UnicodeDecodeError as failure:
        raise MalformedGlbError(
            "the JSON chunk is not UTF-8", byte_offset=chunk.offset + failure.start
        ) from None
    try:
        root = json.loads(
            text,
            object_pairs_hook=_unique_keys,
            parse_constant=_refuse_constant,
            parse_int=_bounded_integer,
            parse_float=_finite_number,
        )
    except json.JSONDecodeError as failure:
        offset = chunk.offset + len(text[: failure.pos].encode())
        raise MalformedGlbError(
            f"the JSON chunk does not parse: {failure.msg}", byte_offset=offset
        ) from None
    if not isinstance(root, dict):
        raise MalformedGlbError("the JSON chunk is not an object", pointer="")
    return root


def format_json(root: dict[str, Any]) -> bytes:
    """Write the document compactly, in UTF-8, numbers as short as they round-trip."""
    text = json.dumps(root, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    # Half a surrogate pair can stand in JSON as an escape, but has no UTF-8 form.
    return _LONE_SURROGATE.sub(lambda match: f"\\u{ord(match[0]):04x}", text).encode()


def _check_shape(text: np.ndarray, offset: int, limits: Limits) -> None:
    """Bound depth and number of values in one pass over the bytes, without recursion."""
    quotes = np.flatnonzero(text == ord('"'))
    quotes = quotes[~_escaped(text, quotes)]
    opens = np.flatnonzero((text == ord("[")) | (text == ord("{")))
    closes = np.flatnonzero((text == ord("]")) | (text == ord("}")))
    commas = np.flatnonzero(text == ord(","))
    opens, closes, commas = (
        marks[np.searchsorted(quotes, marks) % 2 == 0] for marks in (opens, closes, commas)
    )
    values = len(opens) + len(commas)
    if values > limits.json_values:
        raise LimitError(
            f"the JSON chunk has more than {limits.json_values} values", byte_offset=offset
        )
    depth_at_open = np.arange(1, len(opens) + 1) - np.searchsorted(closes, opens)
    if len(opens) and depth_at_open.max() > limits.json_depth:
        where = int(opens[np.argmax(depth_at_open > limits.json_depth)])
        raise LimitError(
            f"the JSON chunk nests deeper than {limits.json_depth}", byte_offset=offset + where
        )


def _escaped(text: np.ndarray, quotes: np.ndarray) -> np.ndarray:
    """Which of the quotes stand after an odd run of backslashes."""
    backslashes = np.flatnonzero(text == ord("\\"))
    escaped = np.zeros(len(quotes), bool)
    if len(backslashes):
        starts_run = np.diff(backslashes, prepend=-2) > 1
        run_start = np.maximum.accumulate(np.where(starts_run, backslashes, 0))
        last = np.searchsorted(backslashes, quotes) - 1
        follows = (last >= 0) & (backslashes[last] == quotes - 1)
        escaped[follows] = (quotes[follows] - run_start[last[follows]]) % 2 == 1
    return escaped


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) != len(pairs):
        seen: set[str] = set()
        for key, _ in pairs:
            if key in seen:
                raise MalformedGlbError(f"the JSON chunk repeats the key {key[:80]!r}")
            seen.add(key)
    return found


def _refuse_constant(name: str) -> NoReturn:
    raise MalformedGlbError(f"the JSON chunk holds {name}, which is no JSON number")


def _bounded_integer(digits: str) -> int:
    if len(digits) > _LONGEST_INTEGER:
        raise MalformedGlbError(f"the JSON chunk holds an integer of {len(digits)} digits")
    return int(digits)


def _finite_number(digits: str) -> float:
    number = float(digits)
    if number in (float("inf"), float("-inf")):
        raise MalformedGlbError(f"the number {digits[:40]} in the JSON chunk is out of range")
    return number
