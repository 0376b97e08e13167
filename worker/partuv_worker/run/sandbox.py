"""What a child may not do: it reads files that strangers made.

The child has no network address to talk to and no secret in its environment; these limits keep it
from taking the machine down. Containers add their own (see docker/compose.yaml).
"""

from __future__ import annotations

import ctypes
import resource
import sys

_PR_SET_NO_NEW_PRIVS = 38
_OPEN_FILES = 256
_FILE_BYTES = 64 * 2**20


def enter(memory_bytes: int) -> None:
    """Limit this process for good; memory_bytes 0 leaves its memory alone."""
    _limit(resource.RLIMIT_CORE, 0)
    _limit(resource.RLIMIT_NOFILE, _OPEN_FILES)
    _limit(resource.RLIMIT_FSIZE, _FILE_BYTES)
    if memory_bytes:
        # Data, not address space: libraries map far more than they use.
        _limit(resource.RLIMIT_DATA, memory_bytes)
    if sys.platform == "linux":
        ctypes.CDLL(None, use_errno=True).prctl(_PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)


def _limit(what: int, amount: int) -> None:
    _, hard = resource.getrlimit(what)
    if hard != resource.RLIM_INFINITY:
        amount = min(amount, hard)
    resource.setrlimit(what, (amount, amount))
