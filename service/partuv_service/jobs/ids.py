"""Names of jobs: UUIDs that sort by time (RFC 9562, version 7)."""

from __future__ import annotations

import re
import secrets
import time

PATTERN = r"^job_[0-9a-f]{32}$"
_VALID = re.compile(PATTERN)
_INSIDE = re.compile(PATTERN.strip("^$").encode())


def new_job_id() -> str:
    """A fresh name."""
    milliseconds = time.time_ns() // 1_000_000
    value = (milliseconds & (2**48 - 1)) << 80 | 0x7 << 76 | secrets.randbits(12) << 64
    value |= 0b10 << 62 | secrets.randbits(62)
    return f"job_{value:032x}"


def is_job_id(text: str) -> bool:
    """True if it could be a job's name."""
    return _VALID.fullmatch(text) is not None


def ids_in(text: bytes) -> set[str]:
    """All names that occur in a text."""
    return {found.decode() for found in _INSIDE.findall(text)}
