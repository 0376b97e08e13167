"""The OpenAPI document: complete, and kept by what the gateway really answers."""

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

import httpx
import pytest
import schemathesis
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from hypothesis.errors import Unsatisfiable
from partuv_contract.option_table import option_table
from partuv_contract.problem import error_kinds
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.support.hand_worker import HandWorker
from tests.support.service import Gateway
from tests.support.uploads import some_glb, submit

ROOT = Path(__file__).resolve().parents[3]
# Codes that belong to a failed job, not to a request.
OF_JOBS = {
    "worker_lost",
    "out_of_memory",
    "time_limit_exceeded",
    "queue_timeout",
    "cancelled",
    "invalid_input",
    "unsupported_feature",
    "external_uri",
    "limit_exceeded",
    "no_triangles",
    "non_finite_position",
    "no_face_with_area",
    "unusable_uv",
    "component_missing",
    "features_unavailable",
    "bad_checkpoint",
}
NOT_OF_ROUTES = {"not_found", "method_not_allowed", "bad_request", "unavailable"}


@pytest.fixture(scope="module")
def document(gateway: Gateway) -> dict[str, Any]:
    return dict(httpx.get(f"{gateway.url}/openapi.json").json())


def operations(document: dict[str, Any]) -> Iterator[tuple[str, str, dict[str, Any]]]:
    for path, methods in document["paths"].items():
        for method, operation in methods.items():
            yield method, path, operation


def test_operations_have_names_summaries_and_problems(document: dict[str, Any]) -> None:
    names = [operation["operationId"] for _, _, operation in operations(document)]
    assert len(names) == len(set(names)) == 19
    for method, path, operation in operations(document):
        assert operation["description"], path
        for status, answer in operation["responses"].items():
            if int(status) >= 400 and method != "head":
                assert list(answer["content"]) == ["application/problem+json"], (path, status)
                assert answer["content"]["application/problem+json"]["examples"]


def test_every_code_is_documented_where_it_may_come(document: dict[str, Any]) -> None:
    shown = {
        code
        for _, _, operation in operations(document)
        for status, answer in operation["responses"].items()
        if int(status) >= 400
        for code in answer["content"]["application/problem+json"]["examples"]
    }
    assert shown | OF_JOBS | NOT_OF_ROUTES >= error_kinds().keys()
    assert all(f"`{code}`" in document["info"]["description"] for code in error_kinds())


def test_options_are_parameters_and_form_fields(document: dict[str, Any]) -> None:
    operation = document["paths"]["/v1/unwrap"]["post"]
    queries = {one["name"] for one in operation["parameters"] if one["in"] == "query"}
    form = operation["requestBody"]["content"]["multipart/form-data"]["schema"]["properties"]
    names = {info.name for info in option_table()}
    assert queries == names | {"webhook_url", "retention_s"}
    assert form.keys() == queries | {"file"}
    assert "model/gltf-binary" in operation["requestBody"]["content"]
    assert document["components"]["securitySchemes"].keys() == {"bearer", "apiKey"}


def test_the_document_in_the_repository_is_current(document: dict[str, Any]) -> None:
    kept = json.loads((ROOT / "docs" / "openapi.json").read_text())
    assert kept == document, "run python proto/generate.py"


schemathesis.openapi.media_type(
    "model/gltf-binary", st.one_of(st.builds(some_glb), st.binary(max_size=200))
)


LONGEST_QUERY = 16_000
KEPT = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_headers_conformance,
    response_schema_conformance,
]


def test_nothing_undocumented_is_answered(
    gateway: Gateway, http: httpx.Client, worker: HandWorker
) -> None:
    """Schemathesis sends what the document allows, and what it does not."""
    jobs = [submit(http) for _ in range(3)]
    worker.succeed(jobs[0])
    worker.fail(jobs[1])
    http.post(f"/v1/jobs/{jobs[2]}/cancel")
    schema = schemathesis.openapi.from_url(f"{gateway.url}/openapi.json")
    for found in schema.get_all_operations():
        operation = found.ok()
        for mode in schemathesis.GenerationMode:

            @given(case=operation.as_strategy(generation_mode=mode), dice=st.integers(0, 5))
            @settings(
                max_examples=8,
                deadline=None,
                derandomize=True,  # the same on every machine; more examples find more
                suppress_health_check=list(HealthCheck),
            )
            def ask(case: schemathesis.Case, dice: int) -> None:
                # A longer line is refused by the HTTP server, before any of this is asked.
                assume(len(urlencode(case.query or {}, doseq=True)) < LONGEST_QUERY)
                if "job_id" in case.path_parameters and dice < len(jobs):
                    case.path_parameters["job_id"] = jobs[dice]
                case.call_and_validate(checks=KEPT, timeout=20.0)

            try:
                ask()
            except Unsatisfiable:
                assert mode is schemathesis.GenerationMode.NEGATIVE, operation.label
