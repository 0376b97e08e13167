"""Completes the OpenAPI document: keys, the problem schema, the list of error codes."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI
from fastapi.openapi.utils import get_openapi
from partuv_contract.problem import Problem, error_kinds, title_of

_OPEN_PATHS = ("/healthz", "/readyz", "/version", "/metrics", "/v1/options")
_DESCRIPTION = """\
POST a GLB, follow the job, fetch the same GLB with a UV atlas of few, part-aligned charts.

Jobs are `queued`, `running`, and at last `succeeded`, `failed` or `canceled`. Every error is an
RFC 9457 problem with a stable `code`; clients should expect codes, stages and members that they do
not know. Times are UTC.

| code | HTTP | meaning |
| --- | --- | --- |
"""


def complete(app: FastAPI) -> None:
    """Give the application its finished document."""

    def document() -> dict[str, Any]:
        if app.openapi_schema is None:
            app.openapi_schema = _document(app)
        return app.openapi_schema

    app.openapi = document  # type: ignore[method-assign]


def _document(app: FastAPI) -> dict[str, Any]:
    codes = "".join(
        f"| `{code}` | {kind.http_status} | {title_of(kind)} |\n"
        for code, kind in error_kinds().items()
    )
    schema = get_openapi(
        title=app.title,
        version=app.version,
        summary="UV unwrapping of GLB meshes",
        description=_DESCRIPTION + codes,
        routes=app.routes,
        license_info={"name": "Apache 2.0", "identifier": "Apache-2.0"},
        servers=[{"url": "/", "description": "this service"}],
    )
    components = schema.setdefault("components", {})
    schemas = components.setdefault("schemas", {})
    problem = Problem.model_json_schema(ref_template="#/components/schemas/{model}")
    schemas |= problem.pop("$defs", {})
    schemas["Problem"] = problem
    # FastAPI's own 422 is not what this service answers.
    schemas.pop("HTTPValidationError", None)
    schemas.pop("ValidationError", None)
    components["securitySchemes"] = {
        "bearer": {"type": "http", "scheme": "bearer"},
        "apiKey": {"type": "apiKey", "in": "header", "name": "X-API-Key"},
    }
    for path, operations in schema["paths"].items():
        for operation in operations.values():
            if path not in _OPEN_PATHS:
                operation["security"] = [{}, {"bearer": []}, {"apiKey": []}]
            _drop_foreign_422(operation["responses"])
    return schema


def _drop_foreign_422(answers: dict[str, Any]) -> None:
    if "application/json" in answers.get("422", {}).get("content", {}):
        del answers["422"]
