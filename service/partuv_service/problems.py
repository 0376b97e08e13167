"""Errors of the REST interface: RFC 9457 problems, everywhere."""

from __future__ import annotations

import logging
import math
from collections.abc import Sequence
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import Response
from partuv_contract.errors import PartuvError
from partuv_contract.problem import FieldProblem, Problem, title_of
from partuv_contract.service_errors import (
    InvalidParameterError,
    JobNotFoundError,
    MalformedRequestError,
    MethodNotAllowedError,
    NotFoundError,
    RateLimitedError,
    ServiceError,
    StoreUnavailableError,
    UnauthorizedError,
)
from starlette.exceptions import HTTPException

_log = logging.getLogger(__name__)
MEDIA_TYPE = "application/problem+json"

# Any route may answer these.
COMMON = (UnauthorizedError, RateLimitedError, StoreUnavailableError, PartuvError)
OF_A_JOB = (JobNotFoundError, *COMMON)


def problem_response(problem: Problem, headers: dict[str, str] | None = None) -> Response:
    """A problem as the answer to a request."""
    return Response(
        problem.model_dump_json(exclude_none=True),
        status_code=problem.status,
        media_type=MEDIA_TYPE,
        headers=headers,
    )


def error_response(error: PartuvError, instance: str | None = None) -> Response:
    """An error as the answer to a request."""
    headers = {}
    if isinstance(error, ServiceError) and error.retry_after_s is not None:
        headers["Retry-After"] = str(max(1, math.ceil(error.retry_after_s)))
    if isinstance(error, UnauthorizedError):
        headers["WWW-Authenticate"] = "Bearer"
    return problem_response(Problem.of(error, instance), headers)


def responses(*kinds: type[PartuvError]) -> dict[int | str, dict[str, Any]]:
    """The OpenAPI description of the problems a route answers with."""
    by_status: dict[int, list[type[PartuvError]]] = {}
    for kind in kinds:
        by_status.setdefault(kind.http_status, []).append(kind)
    return {
        status: {
            "description": "; ".join(title_of(kind) for kind in of_status),
            "content": {
                MEDIA_TYPE: {
                    "schema": {"$ref": "#/components/schemas/Problem"},
                    "examples": {kind.code: _example(kind) for kind in of_status},
                }
            },
            **_headers(of_status),
        }
        for status, of_status in sorted(by_status.items())
    }


def install(app: FastAPI) -> None:
    """Make every error of the application a problem."""
    app.add_exception_handler(PartuvError, _on_partuv_error)
    app.add_exception_handler(RequestValidationError, _on_invalid_request)
    app.add_exception_handler(HTTPException, _on_http_exception)
    app.add_exception_handler(Exception, _on_bug)


def _example(kind: type[PartuvError]) -> dict[str, Any]:
    problem = Problem.of(kind(title_of(kind))).model_dump(exclude_none=True)
    return {"summary": title_of(kind), "value": problem}


def _headers(kinds: Sequence[type[PartuvError]]) -> dict[str, Any]:
    headers: dict[str, Any] = {}
    if any(issubclass(kind, ServiceError) and kind.retry_after_s is not None for kind in kinds):
        headers["Retry-After"] = {
            "description": "Seconds after which to try again",
            "schema": {"type": "integer", "minimum": 1},
        }
    if UnauthorizedError in kinds:
        headers["WWW-Authenticate"] = {
            "description": "How to authenticate",
            "schema": {"type": "string"},
        }
    return {"headers": headers} if headers else {}


async def _on_partuv_error(request: Request, error: Exception) -> Response:
    assert isinstance(error, PartuvError)
    return error_response(error, request.url.path)


async def _on_invalid_request(request: Request, error: Exception) -> Response:
    assert isinstance(error, RequestValidationError)
    errors = [
        FieldProblem(
            pointer="/" + "/".join(str(part) for part in one["loc"][1:]), detail=one["msg"]
        )
        for one in error.errors()
    ]
    summary = InvalidParameterError("; ".join(f"{one.pointer}: {one.detail}" for one in errors))
    problem = Problem.of(summary, request.url.path).model_copy(update={"errors": errors})
    return problem_response(problem)


async def _on_http_exception(request: Request, error: Exception) -> Response:
    assert isinstance(error, HTTPException)
    kinds: dict[int, type[ServiceError]] = {404: NotFoundError, 405: MethodNotAllowedError}
    kind = kinds.get(error.status_code, MalformedRequestError)
    response = error_response(kind(f"{request.method} {request.url.path}"), request.url.path)
    response.headers.update(error.headers or {})
    return response


async def _on_bug(request: Request, error: Exception) -> Response:
    _log.error("unexpected error", exc_info=error)
    return error_response(PartuvError("an unexpected error, see the log"), request.url.path)
