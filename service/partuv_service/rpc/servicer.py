"""The calls of unwrap.proto."""

from __future__ import annotations

import asyncio
import logging
import re
import time
import uuid
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from typing import Any

import grpc
from partuv_contract.errors import PartuvError
from partuv_contract.logs import log_context
from partuv_contract.pb import unwrap_pb2 as pb
from partuv_contract.service_errors import JobNotFoundError, MalformedRequestError
from partuv_store.blobs import CHUNK_BYTES

from partuv_service.callers import Caller
from partuv_service.deps import State
from partuv_service.jobs.upload import Upload, in_time
from partuv_service.rpc import convert
from partuv_service.rpc.unwrap_pb2_grpc import UnwrapServicer

_log = logging.getLogger(__name__)
_SILENCE_S = 3600.0
_REQUEST_ID = re.compile(r"[A-Za-z0-9._-]{1,128}")
_FILES = {
    pb.DownloadResultRequest.FILE_UNSPECIFIED: ("glb", "model/gltf-binary"),
    pb.DownloadResultRequest.FILE_GLB: ("glb", "model/gltf-binary"),
    pb.DownloadResultRequest.FILE_PREVIEW_PNG: ("png", "image/png"),
    pb.DownloadResultRequest.FILE_ATLAS_SVG: ("svg", "image/svg+xml"),
    pb.DownloadResultRequest.FILE_PARTS_GLB: ("parts", "model/gltf-binary"),
}
Context = grpc.aio.ServicerContext[Any, Any]


class Servicer(UnwrapServicer):
    """Asks the desk, as the REST routes do."""

    def __init__(self, state: State) -> None:
        self._state = state
        self._desk = state.desk

    async def SubmitUnwrap(
        self, requests: AsyncIterator[pb.SubmitUnwrapRequest], context: Context
    ) -> pb.Job:
        async with self._call("SubmitUnwrap", context) as (caller, request_id):
            messages = in_time(requests, self._state.settings.upload_idle_timeout_s)
            first = await anext(messages, None)
            if first is None or first.WhichOneof("part") != "request":
                raise MalformedRequestError("the first message holds the request")
            order = convert.to_order(first.request, request_id)
            await self._desk.check(order)
            upload = await self._desk.open_upload(caller, 0)
            try:
                await _feed(upload, messages)
                accepted = await self._desk.submit(caller, upload, order)
            except BaseException:
                await upload.abandon()
                raise
            return convert.to_message(accepted.record)

    async def GetJob(self, request: pb.GetJobRequest, context: Context) -> pb.Job:
        async with self._call("GetJob", context) as (caller, _):
            return convert.to_message(await self._desk.view(caller, request.id))

    async def WatchJob(
        self, request: pb.WatchJobRequest, context: Context
    ) -> AsyncIterator[pb.Job]:
        async with self._call("WatchJob", context) as (caller, _):
            async for record in self._desk.watch(caller, request.id, silence_s=_SILENCE_S):
                if record is not None:
                    yield convert.to_message(record)

    async def CancelJob(self, request: pb.CancelJobRequest, context: Context) -> pb.Job:
        async with self._call("CancelJob", context) as (caller, _):
            record = await self._desk.cancel(caller, request.id)
            if request.forget:
                await self._desk.forget(caller, request.id)
            return convert.to_message(record)

    async def DownloadResult(
        self, request: pb.DownloadResultRequest, context: Context
    ) -> AsyncIterator[pb.DownloadResultResponse]:
        async with self._call("DownloadResult", context) as (caller, _):
            if request.file not in _FILES:
                raise MalformedRequestError(f"there is no file {request.file}", pointer="/file")
            kind, media_type = _FILES[request.file]
            file = await self._desk.result(caller, request.id, kind)
            description = pb.DownloadResultResponse.Description(
                bytes=file.bytes, sha256=file.sha256, media_type=media_type
            )
            yield pb.DownloadResultResponse(description=description)
            for index in range(-(-file.bytes // CHUNK_BYTES)):
                chunk = await self._state.store.read_chunk(file.blob, index)
                if chunk is None:
                    raise JobNotFoundError("the result was deleted while it was sent")
                yield pb.DownloadResultResponse(chunk=chunk)

    @asynccontextmanager
    async def _call(self, method: str, context: Context) -> AsyncIterator[tuple[Caller, str]]:
        """Knows the caller, and turns errors into statuses; logs and counts the call."""
        metadata = dict(context.invocation_metadata() or ())
        request_id = str(metadata.get("x-request-id", ""))
        if not _REQUEST_ID.fullmatch(request_id):
            request_id = uuid.uuid4().hex
        started = time.perf_counter()
        code = grpc.StatusCode.OK
        error: PartuvError | None = None
        with log_context(request_id=request_id):
            await context.send_initial_metadata((("x-request-id", request_id),))
            try:
                caller = self._state.keys.caller(
                    _text(metadata.get("authorization")), _text(metadata.get("x-api-key"))
                )
                await self._desk.admit(caller)
                yield caller, request_id
            except PartuvError as failure:
                error = failure
            except asyncio.CancelledError:
                code = grpc.StatusCode.CANCELLED
                raise
            except Exception as failure:
                _log.exception("unexpected error")
                error = PartuvError("an unexpected error, see the log")
                error.__cause__ = failure
            finally:
                code = convert.code_of(error) if error else code
                self._state.metrics.rpcs.labels(method, code.name).inc()
                duration_ms = round((time.perf_counter() - started) * 1000, 2)
                extra = {"method": method, "code": code.name, "duration_ms": duration_ms}
                _log.info("call", extra=extra)
            if error is not None:
                await context.abort(convert.code_of(error), str(error), convert.details_of(error))


def _text(value: str | bytes | None) -> str | None:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


async def _feed(upload: Upload, messages: AsyncIterator[pb.SubmitUnwrapRequest]) -> None:
    async for message in messages:
        if message.WhichOneof("part") != "chunk":
            raise MalformedRequestError("only the first message holds a request")
        await upload.feed(message.chunk)
