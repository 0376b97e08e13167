"""Between the messages of unwrap.proto and the contract's models."""

from __future__ import annotations

from typing import Any

from google.protobuf import json_format
from google.protobuf.descriptor import FieldDescriptor
from google.rpc import error_details_pb2, status_pb2
from grpc import StatusCode
from partuv_contract.errors import PartuvError
from partuv_contract.options import UnwrapOptions
from partuv_contract.pb import unwrap_pb2 as pb
from partuv_contract.service_errors import ServiceError
from partuv_store import JobRecord

from partuv_service.jobs.desk import Order
from partuv_service.jobs.view import to_job

DOMAIN = "partuv"


def to_order(request: pb.UnwrapRequest, request_id: str) -> Order:
    """The order in the first message; raises `OptionError`."""
    values = {
        field.name: list(value) if field.is_repeated else value
        for field, value in request.options.ListFields()
    }
    return Order(
        options=UnwrapOptions.parse(values),
        retention_s=request.retention_s or None,
        webhook_url=request.webhook_url or None,
        idempotency_key=request.idempotency_key or None,
        request_id=request_id,
    )


def to_message(record: JobRecord) -> pb.Job:
    """The job as a message."""
    document = to_job(record).model_dump(mode="json", exclude={"links"})
    document["status"] = f"JOB_STATUS_{record.status.value.upper()}"
    options = pb.UnwrapOptions.DESCRIPTOR.fields_by_name
    document["options"] = {
        name: str(value) if _is_text(options[name]) else value
        for name, value in document["options"].items()
        if value is not None
    }
    return json_format.ParseDict(_without_none(document), pb.Job())


def code_of(error: PartuvError) -> StatusCode:
    """The gRPC status of an error."""
    return StatusCode[error.grpc_status]


def details_of(error: PartuvError) -> tuple[tuple[str, bytes], ...]:
    """Trailing metadata that carries the error's code, place and time to retry."""
    status = status_pb2.Status(code=code_of(error).value[0], message=str(error))
    status.details.add().Pack(error_details_pb2.ErrorInfo(reason=error.code, domain=DOMAIN))
    if error.pointer is not None:
        violation = error_details_pb2.BadRequest.FieldViolation(
            field=error.pointer, description=error.message
        )
        status.details.add().Pack(error_details_pb2.BadRequest(field_violations=[violation]))
    if isinstance(error, ServiceError) and error.retry_after_s is not None:
        retry = error_details_pb2.RetryInfo()
        retry.retry_delay.FromMilliseconds(round(error.retry_after_s * 1000))
        status.details.add().Pack(retry)
    return (("grpc-status-details-bin", status.SerializeToString()),)


def _is_text(field: Any) -> bool:
    return bool(field.type == FieldDescriptor.TYPE_STRING and not field.is_repeated)


def _without_none(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _without_none(one) for name, one in value.items() if one is not None}
    return value
