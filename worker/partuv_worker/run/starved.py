"""How a lack of memory sounds, whoever complains of it."""

from __future__ import annotations

# C++, Python, the C library, OpenBLAS; threads that find no room for their stack.
_COMPLAINTS = (
    "bad_alloc",
    "MemoryError",
    "Cannot allocate memory",
    "emory allocation",
    "Resource temporarily unavailable",
    "can't start new thread",
)


def tells_of_no_memory(text: str) -> bool:
    """True if the text, a message or a line of a log, tells that memory ran out."""
    return any(complaint in text for complaint in _COMPLAINTS)
