"""POST a GLB."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Header, Request
from fastapi.responses import RedirectResponse, Response
from partuv_contract.errors import MalformedGlbError, NotGlbError, OptionError, PartuvError
from partuv_contract.jobs import Job, JobStatus
from partuv_contract.option_table import option_table
from partuv_contract.problem import Problem
from partuv_contract.service_errors import (
    IdempotencyError,
    InvalidParameterError,
    MalformedRequestError,
    MediaTypeError,
    QueueFullError,
    StoreFullError,
    TooManyJobsError,
    UploadTooLargeError,
    WebhookRefusedError,
)

from partuv_service.callers import Caller
from partuv_service.deps import CallerDep, State, StateDep
from partuv_service.jobs.desk import Accepted
from partuv_service.jobs.view import job_path, to_json
from partuv_service.problems import COMMON, problem_response, responses
from partuv_service.routes import order as orders

router = APIRouter(tags=["unwrap"])
_FORM_OVERHEAD_BYTES = 256 * 1024
_DRAIN_BYTES = 64 * 2**20
_DRAIN_S = 5.0
_PROBLEMS = responses(
    MalformedRequestError,
    UploadTooLargeError,
    MediaTypeError,
    NotGlbError,
    MalformedGlbError,
    OptionError,
    InvalidParameterError,
    WebhookRefusedError,
    IdempotencyError,
    TooManyJobsError,
    QueueFullError,
    StoreFullError,
    *COMMON,
)


def _documentation() -> dict[str, Any]:
    """What FastAPI can't see: the body, and the options as parameters."""
    options = [(info.name, info.meaning, info.value_schema) for info in option_table()]
    extras = [
        ("webhook_url", "https address that is called when the job has ended",
         {"type": "string", "format": "uri", "maxLength": 2048, "pattern": "^https://"}),
        ("retention_s", "seconds to keep the job after its end, less than usual",
         {"type": "integer", "minimum": 1}),
    ]  # fmt: skip
    fields = {name: {**schema, "description": text} for name, text, schema in options + extras}
    file = {"type": "string", "contentMediaType": orders.GLB, "description": "the GLB"}
    form = {"type": "object", "required": ["file"], "properties": {"file": file, **fields}}
    binary = {"type": "string", "contentMediaType": orders.GLB, "format": "binary"}
    return {
        "parameters": [
            {"name": name, "in": "query", "description": text, "schema": schema}
            for name, text, schema in options + extras
        ],
        "requestBody": {
            "required": True,
            "content": {
                orders.GLB: {"schema": binary},
                "multipart/form-data": {"schema": form},
            },
        },
    }


_ANSWERS: dict[int | str, dict[str, Any]] = {
    200: {"model": Job, "description": "`Prefer: wait`: the job has ended"},
    202: {
        "model": Job,
        "description": "The job is accepted",
        "headers": {
            "Location": {"description": "The job", "schema": {"type": "string"}},
            "Retry-After": {"description": "Seconds", "schema": {"type": "integer"}},
            "Idempotency-Replayed": {
                "description": "true if this job came from an earlier request",
                "schema": {"type": "string"},
            },
        },
    },
    303: {"description": "`Prefer: wait` and `Accept: model/gltf-binary`: the result is there"},
    **_PROBLEMS,
}


async def submit_unwrap(
    request: Request,
    caller: CallerDep,
    state: StateDep,
    prefer: Annotated[
        str | None, Header(description="`wait=30` answers when the job has ended, within 60 s")
    ] = None,
    idempotency_key: Annotated[
        str | None, Header(description="The same key and request give the same job")
    ] = None,
) -> Response:
    """Unwrap a GLB: answers at once with the job that will hold the result."""
    accepted = await _take(request, caller, state, idempotency_key)
    wait_s = orders.wait_s(prefer)
    if wait_s is None:
        return _accepted(accepted)
    record = await state.desk.wait(caller, accepted.record, wait_s)
    accepted = Accepted(record, accepted.replayed)
    if not record.status.final:
        return _accepted(accepted)
    if orders.GLB in request.headers.get("accept", ""):
        return _only_the_result(accepted)
    return Response(to_json(record), media_type="application/json", headers=_headers(accepted))


for _path, _name in (("/v1/unwrap", "submitUnwrap"), ("/unwrap", "submitUnwrapAlias")):
    router.post(
        _path,
        operation_id=_name,
        status_code=202,
        response_model=None,
        responses=_ANSWERS,
        openapi_extra=_documentation(),
    )(submit_unwrap)


async def _take(
    request: Request, caller: Caller, state: State, idempotency_key: str | None
) -> Accepted:
    upload = None
    try:
        form = orders.media_type(request) == "multipart/form-data"
        announced = orders.announced_bytes(request) - (_FORM_OVERHEAD_BYTES if form else 0)
        query = orders.parameters(request.query_params.multi_items())
        request_id = request.state.request_id
        await state.desk.check(orders.to_order(query, idempotency_key, request_id))
        upload = await state.desk.open_upload(caller, max(0, announced))
        fields = orders.parameters(
            await orders.read_upload(request, upload, state.settings.upload_idle_timeout_s)
        )
        order = orders.to_order(orders.merged(query, fields), idempotency_key, request_id)
        await state.desk.check(order)
        return await state.desk.submit(caller, upload, order)
    except BaseException as failure:
        if upload is not None:
            await upload.abandon()
        if isinstance(failure, PartuvError):
            await orders.drain(request, _DRAIN_BYTES, _DRAIN_S)
        raise


def _accepted(accepted: Accepted) -> Response:
    headers = _headers(accepted) | {"Retry-After": "1"}
    content = to_json(accepted.record)
    return Response(content, status_code=202, media_type="application/json", headers=headers)


def _only_the_result(accepted: Accepted) -> Response:
    """For clients that want nothing but the GLB: where it is, or why there is none."""
    record = accepted.record
    path = job_path(record.id)
    if record.status is JobStatus.SUCCEEDED:
        return RedirectResponse(f"{path}/result", 303, headers=_headers(accepted, at="/result"))
    if record.status is JobStatus.FAILED:
        problem = Problem.model_validate(record.document("error"))
        return problem_response(problem.model_copy(update={"instance": path}), _headers(accepted))
    return Response(
        to_json(record), status_code=200, media_type="application/json", headers=_headers(accepted)
    )


def _headers(accepted: Accepted, at: str = "") -> dict[str, str]:
    headers = {"Location": job_path(accepted.record.id) + at}
    if accepted.replayed:
        headers["Idempotency-Replayed"] = "true"
    return headers
