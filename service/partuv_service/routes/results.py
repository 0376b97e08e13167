"""Fetch what a job made: the GLB, and its atlas drawn."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Header, Request
from fastapi.responses import Response, StreamingResponse
from partuv_contract.service_errors import (
    JobNotFoundError,
    NoResultError,
    NotFoundError,
    RangeError,
    ResultNotReadyError,
)
from partuv_store import AsyncStore
from partuv_store.blobs import CHUNK_BYTES

from partuv_service.deps import CallerDep, StateDep
from partuv_service.jobs.desk import ResultFile
from partuv_service.problems import OF_A_JOB, error_response, responses
from partuv_service.routes.jobs import JobId

router = APIRouter(prefix="/v1/jobs", tags=["results"])
_RANGE = re.compile(r"bytes=(\d{0,18})-(\d{0,18})")


def _documentation(media_type: str, schema: dict[str, Any]) -> dict[int | str, dict[str, Any]]:
    content = {media_type: {"schema": schema}}
    etag = {"description": "Digest of the bytes", "schema": {"type": "string"}}
    part = {"description": "Which bytes", "schema": {"type": "string"}}
    return {
        200: {"description": "The file", "content": content, "headers": {"ETag": etag}},
        206: {
            "description": "The part asked for by `Range`",
            "content": content,
            "headers": {"ETag": etag, "Content-Range": part},
        },
        304: {"description": "`If-None-Match` names this very file", "headers": {"ETag": etag}},
        **responses(ResultNotReadyError, NoResultError, NotFoundError, RangeError, *OF_A_JOB),
    }


_BINARY = {"type": "string", "format": "binary"}
_FILES = (
    ("result", "Result", "glb", "model/gltf-binary", _BINARY),
    ("preview.png", "Preview", "png", "image/png", _BINARY),
    ("atlas.svg", "Atlas", "svg", "image/svg+xml", {"type": "string"}),
    ("parts.glb", "Parts", "parts", "model/gltf-binary", _BINARY),
)
_MEANINGS = {
    "glb": "The GLB with its new atlas.",
    "png": "The atlas drawn, charts coloured by part.",
    "svg": "The atlas drawn as vectors, charts coloured by part.",
    "parts": "The surface coloured by part, made where option `parts` is not `search`.",
}


def _add_routes(path: str, name: str, kind: str, media_type: str, schema: dict[str, Any]) -> None:
    suffix = "parts.glb" if kind == "parts" else kind

    async def download(
        request: Request,
        job_id: JobId,
        caller: CallerDep,
        state: StateDep,
        range_: Annotated[str | None, Header(alias="Range")] = None,
        if_none_match: Annotated[str | None, Header()] = None,
        if_range: Annotated[str | None, Header()] = None,
    ) -> Response:
        file = await state.desk.result(caller, job_id, kind)
        headers = _headers(file, f"{job_id}.{suffix}", attachment=suffix.endswith("glb"))
        if _names(if_none_match, headers["ETag"]):
            return Response(status_code=304, headers=headers)
        span = None if if_range not in (None, headers["ETag"]) else _span(range_, file.bytes)
        if isinstance(span, RangeError):
            response = error_response(span, request.url.path)
            response.headers["Content-Range"] = f"bytes */{file.bytes}"
            return response
        first, last = span or (0, file.bytes - 1)
        headers["Content-Length"] = str(last - first + 1)
        if span:
            headers["Content-Range"] = f"bytes {first}-{last}/{file.bytes}"
        status = 206 if span else 200
        if request.method == "HEAD":
            return Response(status_code=status, headers=headers, media_type=media_type)
        content = _read(state.store, file.blob, first, last)
        return StreamingResponse(content, status, headers, media_type)

    download.__doc__ = _MEANINGS[kind]
    documentation = _documentation(media_type, schema)
    for method, verb in (("GET", "get"), ("HEAD", "head")):
        router.add_api_route(
            f"/{{job_id}}/{path}",
            download,
            methods=[method],
            operation_id=f"{verb}{name}",
            response_model=None,
            response_class=Response,
            responses=documentation,
        )


for _file in _FILES:
    _add_routes(*_file)


def _headers(file: ResultFile, name: str, *, attachment: bool) -> dict[str, str]:
    return {
        "ETag": f'"{file.sha256}"',
        "Accept-Ranges": "bytes",
        "Cache-Control": "private, max-age=3600",
        "Content-Disposition": f'{"attachment" if attachment else "inline"}; filename="{name}"',
        "X-Content-Type-Options": "nosniff",
        "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
    }


def _names(if_none_match: str | None, etag: str) -> bool:
    tags = [tag.strip().removeprefix("W/") for tag in (if_none_match or "").split(",")]
    return etag in tags or tags == ["*"]


def _span(header: str | None, size: int) -> tuple[int, int] | RangeError | None:
    """First and last byte that a Range header asks for; None to send everything.

    Several ranges, other units and what can't be read are ignored, as RFC 9110 allows.
    """
    found = _RANGE.fullmatch((header or "").strip())
    if found is None or found[0] == "bytes=-":
        return None
    if not found[1]:
        length = min(int(found[2]), size)
        return (size - length, size - 1) if length else RangeError("an empty range")
    first = int(found[1])
    last = min(int(found[2]), size - 1) if found[2] else size - 1
    if first >= size:
        return RangeError(f"the file has {size} bytes")
    return (first, last) if first <= last else None


async def _read(store: AsyncStore, blob: str, first: int, last: int) -> AsyncIterator[bytes]:
    for index in range(first // CHUNK_BYTES, last // CHUNK_BYTES + 1):
        chunk = await store.read_chunk(blob, index)
        if chunk is None:
            raise JobNotFoundError("the result was deleted while it was sent")
        start = index * CHUNK_BYTES
        yield chunk[max(0, first - start) : last + 1 - start]
