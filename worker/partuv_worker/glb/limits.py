"""What a reader is willing to take on, checked before anything is allocated."""

from __future__ import annotations

from dataclasses import dataclass

MIB = 1 << 20


@dataclass(frozen=True)
class Limits:
    """Upper bounds for one file. Crossing one raises `LimitError` with its name."""

    file_bytes: int = 512 * MIB
    json_bytes: int = 64 * MIB
    json_depth: int = 64  # nested lists and objects
    json_values: int = 4_000_000  # commas, colons and brackets outside strings
    nodes: int = 500_000
    node_depth: int = 1_000
    primitives: int = 100_000
    vertices: int = 20_000_000  # over all primitives, shared ones counted each time
    faces: int = 8_000_000
    decoded_bytes: int = 2048 * MIB  # of all accessors, and of all compressed streams
    expansion: int = 2000  # decoded bytes per byte of a compressed stream


DEFAULT_LIMITS = Limits()
