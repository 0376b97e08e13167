"""An upload on its way into the store: hashed, counted and checked while it comes in."""

from __future__ import annotations

import asyncio
import hashlib
import struct
from collections.abc import AsyncIterator
from dataclasses import dataclass
from typing import TypeVar

from partuv_contract.errors import MalformedGlbError, NotGlbError
from partuv_contract.service_errors import MalformedRequestError, UploadTooLargeError
from partuv_store import AsyncStore
from partuv_store.blobs import CHUNK_BYTES, append, drop, upload_name

_Piece = TypeVar("_Piece")
_HEADER = struct.Struct("<4sII")


@dataclass(frozen=True)
class Received:
    """An upload that is complete."""

    sha256: str
    bytes: int
    chunks: int


class Upload:
    """Takes bytes as they come; raises as soon as they can't become a job any more.

    Only the container's header is looked at: what is inside is the worker's business.
    """

    def __init__(
        self, store: AsyncStore, job_id: str, *, max_bytes: int, budget_bytes: int
    ) -> None:
        self.job_id = job_id
        self._store = store
        self._max_bytes = max_bytes
        self._budget_bytes = budget_bytes
        self._digest = hashlib.sha256()
        self._bytes = 0
        self._chunks = 0
        self._buffer = bytearray()
        self._announced: int | None = None

    async def feed(self, data: bytes) -> None:
        """Take the next bytes."""
        self._bytes += len(data)
        if self._bytes > self._max_bytes:
            raise UploadTooLargeError(f"the upload has more than {self._max_bytes} bytes")
        self._digest.update(data)
        self._buffer += data
        if self._announced is None and len(self._buffer) >= _HEADER.size:
            self._announced = _announced_bytes(bytes(self._buffer[: _HEADER.size]))
        while len(self._buffer) >= CHUNK_BYTES:
            await self._write(bytes(self._buffer[:CHUNK_BYTES]))
            del self._buffer[:CHUNK_BYTES]

    async def complete(self) -> Received:
        """Store the rest; raises if the upload is shorter than its header says."""
        if self._announced is None:
            raise NotGlbError(f"{self._bytes} bytes are no binary glTF 2.0 container")
        if self._announced > self._bytes:
            raise MalformedGlbError(
                f"the header announces {self._announced} bytes, {self._bytes} came", byte_offset=8
            )
        if self._buffer:
            await self._write(bytes(self._buffer))
            self._buffer.clear()
        return Received(self._digest.hexdigest(), self._bytes, self._chunks)

    async def abandon(self) -> None:
        """Drop what was stored."""
        if self._chunks:
            await self._store.run(drop(upload_name(self.job_id)))

    async def _write(self, chunk: bytes) -> None:
        name = upload_name(self.job_id)
        index, self._chunks = self._chunks, self._chunks + 1
        await self._store.run(append(name, index, chunk, budget_bytes=self._budget_bytes))


async def in_time(pieces: AsyncIterator[_Piece], idle_timeout_s: float) -> AsyncIterator[_Piece]:
    """What comes in, as long as no wait for the next piece is longer than that."""
    while True:
        try:
            async with asyncio.timeout(idle_timeout_s):
                piece = await anext(pieces)
        except StopAsyncIteration:
            return
        except TimeoutError as failure:
            raise MalformedRequestError(f"no data for {idle_timeout_s:g} s") from failure
        yield piece


def _announced_bytes(header: bytes) -> int:
    magic, version, length = _HEADER.unpack(header)
    if magic != b"glTF":
        raise NotGlbError("the upload does not begin like a GLB", byte_offset=0)
    if version != 2:
        raise NotGlbError(f"binary glTF {version}; only version 2 is read", byte_offset=4)
    return int(length)
