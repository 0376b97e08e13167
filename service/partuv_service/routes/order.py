"""Reads a submission: the body into an upload, queries, fields and headers into an order."""

from __future__ import annotations

import asyncio
import re
from collections.abc import AsyncIterator, Iterable

from fastapi import Request
from partuv_contract.option_table import option_table
from partuv_contract.options import UnwrapOptions
from partuv_contract.service_errors import (
    InvalidParameterError,
    MalformedRequestError,
    MediaTypeError,
)
from starlette.requests import ClientDisconnect

from partuv_service.jobs.desk import Order
from partuv_service.jobs.upload import Upload, in_time
from partuv_service.routes.forms import FormReader

GLB = "model/gltf-binary"
MAX_WAIT_S = 60.0
_DRAIN_SILENCE_S = 0.5
Parameters = dict[str, str | list[str]]
_LISTS = {info.name for info in option_table() if info.value_schema.get("type") == "array"}
_RAW = {GLB, "application/octet-stream", ""}
_WAIT = re.compile(r"\s*wait\s*=\s*\"?(\d{1,6})\"?\s*")


def media_type(request: Request) -> str:
    """The type of the body; raises `MediaTypeError` unless it can hold a GLB."""
    kind = request.headers.get("content-type", "").partition(";")[0].strip().lower()
    if kind not in _RAW and kind != "multipart/form-data":
        raise MediaTypeError(f"send {GLB} or multipart/form-data, not {kind[:80]}")
    return kind


def announced_bytes(request: Request) -> int:
    """The Content-Length, 0 where there is none."""
    length = request.headers.get("content-length", "0")
    if not length.isascii() or not length.isdigit():
        raise MalformedRequestError("Content-Length is no number")
    return int(length)


async def read_upload(
    request: Request, upload: Upload, idle_timeout_s: float
) -> list[tuple[str, str]]:
    """Read the body into the upload; the form's fields, if it is a form."""
    body = _body(request, idle_timeout_s)
    if media_type(request) == "multipart/form-data":
        return await FormReader(request.headers["content-type"], upload.feed).read(body)
    async for data in body:
        await upload.feed(data)
    return []


def parameters(pairs: Iterable[tuple[str, str]]) -> Parameters:
    """Names with their values; only options that are lists may come several times."""
    found: Parameters = {}
    for name, value in pairs:
        if name in _LISTS:
            earlier = found.setdefault(name, [])
            assert isinstance(earlier, list)
            earlier.append(value)
        elif name in found:
            raise InvalidParameterError("is given more than once", pointer=f"/{name}")
        else:
            found[name] = value
    return found


def merged(query: Parameters, fields: Parameters) -> Parameters:
    """Query and form together; a parameter may stand in both only with the same value."""
    for name in query.keys() & fields.keys():
        if query[name] != fields[name]:
            raise InvalidParameterError("differs between query and form", pointer=f"/{name}")
    return query | fields


def to_order(given: Parameters, idempotency_key: str | None, request_id: str) -> Order:
    """The order that parameters make; raises `OptionError` or `InvalidParameterError`."""
    options = dict(given)
    webhook_url = options.pop("webhook_url", None)
    retention = options.pop("retention_s", None)
    if retention is not None and not re.fullmatch(r"[0-9]{1,9}", str(retention)):
        raise InvalidParameterError("a whole number of seconds", pointer="/retention_s")
    return Order(
        options=UnwrapOptions.parse(options),
        retention_s=None if retention is None else int(str(retention)),
        webhook_url=None if webhook_url is None else str(webhook_url),
        idempotency_key=idempotency_key,
        request_id=request_id,
    )


def wait_s(prefer: str | None) -> float | None:
    """Seconds that `Prefer: wait=…` (RFC 7240) asks to wait, at most a minute."""
    for preference in (prefer or "").split(","):
        found = _WAIT.fullmatch(preference.partition(";")[0])
        if found:
            return min(float(found[1]), MAX_WAIT_S)
    return None


async def drain(request: Request, at_most_bytes: int, at_most_s: float) -> None:
    """Read and drop the rest of a refused body, within bounds, as long as it keeps coming.

    A client that is still sending would see a broken connection instead of the answer.
    """
    try:
        async with asyncio.timeout(at_most_s):
            async for data in _body(request, _DRAIN_SILENCE_S):
                at_most_bytes -= len(data)
                if at_most_bytes < 0:
                    return
    except (TimeoutError, MalformedRequestError, RuntimeError):
        return  # RuntimeError: the body had been read already


async def _body(request: Request, idle_timeout_s: float) -> AsyncIterator[bytes]:
    try:
        async for data in in_time(request.stream(), idle_timeout_s):
            if data:
                yield data
    except ClientDisconnect as failure:
        raise MalformedRequestError("the client went away") from failure
