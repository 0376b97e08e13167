"""What the service's interfaces are made from, and that they agree."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest
from google.protobuf.descriptor import FieldDescriptor
from partuv_contract import errors, problem, service_errors
from partuv_contract.jobs import Job, JobStatus
from partuv_contract.option_table import option_table
from partuv_contract.options import UnwrapOptions
from partuv_contract.pb import unwrap_pb2 as pb

ROOT = Path(__file__).resolve().parents[3]


def test_every_error_has_its_own_code_and_statuses() -> None:
    # Other components add kinds of their own once they are imported.
    kinds = {
        code: kind
        for code, kind in problem.error_kinds().items()
        if kind.__module__.startswith("partuv_contract.")
    }
    defined = [
        node.name
        for module in (errors, service_errors)
        for node in ast.parse(Path(module.__file__).read_text()).body
        if isinstance(node, ast.ClassDef)
    ]
    own = [name for name in defined if name not in ("ServiceError", "JobError")]
    assert sorted(kind.__name__ for kind in kinds.values()) == sorted(own)
    for code, kind in kinds.items():
        assert kind.code == code
        assert 400 <= kind.http_status < 600
        assert kind.grpc_status in GRPC_CODES
        assert problem.title_of(kind)


GRPC_CODES = {
    "CANCELLED",
    "INTERNAL",
    "INVALID_ARGUMENT",
    "NOT_FOUND",
    "UNAUTHENTICATED",
    "RESOURCE_EXHAUSTED",
    "FAILED_PRECONDITION",
    "OUT_OF_RANGE",
    "UNAVAILABLE",
    "UNIMPLEMENTED",
    "DEADLINE_EXCEEDED",
}


@pytest.mark.parametrize("module", [errors, service_errors])
def test_the_tree_in_the_docstring_is_the_real_one(module) -> None:
    drawn = module.__doc__ or ""
    for node in ast.parse(Path(module.__file__).read_text()).body:
        if isinstance(node, ast.ClassDef):
            kind = getattr(module, node.name)
            assert node.name in drawn
            if "code" in vars(kind):
                own = kind.code in ("internal", "invalid_input", "bad_request")
                assert own or kind.code in drawn


def test_a_problem_tells_the_error() -> None:
    error = errors.MalformedGlbError("accessor 0 is short", pointer="/accessors/0")
    told = problem.Problem.of(error, "/v1/jobs/x")
    assert (told.status, told.code, told.instance) == (422, "malformed_glb", "/v1/jobs/x")
    assert told.errors[0].pointer == "/accessors/0"


def test_the_grpc_job_has_the_members_of_the_rest_job() -> None:
    message = {field.name for field in pb.Job.DESCRIPTOR.fields}
    assert message == set(Job.model_fields) - {"links"}
    words = {value.name for value in pb.JobStatus.DESCRIPTOR.values}
    assert words == {f"JOB_STATUS_{status.name}" for status in JobStatus} | {
        "JOB_STATUS_UNSPECIFIED"
    }


def test_the_grpc_options_are_the_options() -> None:
    fields = pb.UnwrapOptions.DESCRIPTOR.fields_by_name
    assert set(fields) == set(UnwrapOptions.model_fields)
    kinds = {"number": "TYPE_DOUBLE", "integer": "TYPE_INT64", "boolean": "TYPE_BOOL"}
    for info in option_table():
        field = fields[info.name]
        if info.value_schema.get("type") in kinds:
            assert field.type == getattr(FieldDescriptor, kinds[info.value_schema["type"]])
        assert field.has_presence or field.is_repeated, "unset means: the default"


def test_the_generated_code_is_current() -> None:
    pytest.importorskip("grpc_tools")
    command = [sys.executable, str(ROOT / "proto" / "generate.py"), "--check"]
    check = subprocess.run(command, capture_output=True, text=True)
    assert check.returncode == 0, check.stdout + check.stderr


def test_the_tables_of_the_documentation_are_current() -> None:
    command = [sys.executable, str(ROOT / "docs" / "tables.py"), "--check"]
    check = subprocess.run(command, capture_output=True, text=True)
    assert check.returncode == 0, check.stdout + check.stderr


def test_the_contract_imports_only_what_it_may() -> None:
    allowed = {"pydantic", "google", "partuv_contract", "__future__"} | sys.stdlib_module_names
    for path in (ROOT / "proto" / "partuv_contract").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = []
            if isinstance(node, ast.Import):
                names = [alias.name for alias in node.names]
            elif isinstance(node, ast.ImportFrom):
                names = [node.module or "partuv_contract"]
            assert {name.partition(".")[0] for name in names} <= allowed, path
