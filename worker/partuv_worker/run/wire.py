"""How supervisor and child talk: frames of JSON and bytes over a socket pair.

Neither side unpickles: the child reads hostile files and may be anybody's by the time it answers.
"""

from __future__ import annotations

import json
import select
import socket
import struct
import threading
from typing import Any, NamedTuple

_PREFIX = struct.Struct("<II")
_MAX_HEADER_BYTES = 32 * 2**20  # a report lists every chart
_MAX_PAYLOAD_BYTES = 2**20
_STALL_S = 60.0


class LinkClosed(Exception):
    """The other side is gone, or talks nonsense."""


class Frame(NamedTuple):
    """One message."""

    kind: str
    header: dict[str, Any]
    payload: bytes


class Link:
    """One end of the line; several threads may send."""

    def __init__(self, end: socket.socket) -> None:
        self._socket = end
        self._socket.settimeout(_STALL_S)
        self._lock = threading.Lock()
        self._poll = select.poll()
        self._poll.register(end, select.POLLIN)

    def send(self, kind: str, payload: bytes = b"", **header: Any) -> None:
        """Send one frame; raises `LinkClosed` if nobody takes it."""
        head = json.dumps({"kind": kind, **header}).encode()
        try:
            with self._lock:
                self._socket.sendall(_PREFIX.pack(len(head), len(payload)) + head)
                self._socket.sendall(payload)
        except OSError as failure:
            raise LinkClosed(str(failure)) from failure

    def receive(self, at_most_s: float | None = None) -> Frame | None:
        """The next frame, None if none began within the time; raises `LinkClosed`."""
        timeout_ms = None if at_most_s is None else max(0.0, at_most_s * 1000)
        if not self._poll.poll(timeout_ms):
            return None
        head_bytes, payload_bytes = _PREFIX.unpack(self._read(_PREFIX.size))
        if head_bytes > _MAX_HEADER_BYTES or payload_bytes > _MAX_PAYLOAD_BYTES:
            raise LinkClosed("a frame is too large")
        try:
            header = json.loads(self._read(head_bytes))
            return Frame(str(header.pop("kind")), header, self._read(payload_bytes))
        except (ValueError, KeyError, AttributeError, RecursionError) as failure:
            raise LinkClosed("a frame can't be read") from failure

    def close(self) -> None:
        self._socket.close()

    def _read(self, count: int) -> bytes:
        pieces = bytearray()
        while len(pieces) < count:
            try:
                piece = self._socket.recv(min(count - len(pieces), 2**20))
            except OSError as failure:
                raise LinkClosed(str(failure)) from failure
            if not piece:
                raise LinkClosed("the other side hung up")
            pieces += piece
        return bytes(pieces)
