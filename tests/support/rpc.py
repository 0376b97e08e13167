"""Helpers for gRPC calls."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import grpc
from google.rpc import error_details_pb2, status_pb2
from partuv_contract.pb import unwrap_pb2 as pb


def messages(content: bytes, chunk: int = 100_000, **request: Any) -> Iterator[Any]:
    """A submission as a stream."""
    yield pb.SubmitUnwrapRequest(request=pb.UnwrapRequest(**request))
    for start in range(0, len(content), chunk):
        yield pb.SubmitUnwrapRequest(chunk=content[start : start + chunk])


def reason(failure: grpc.RpcError) -> tuple[grpc.StatusCode, str]:
    """The status of a failed call, and the code in its details."""
    trailing = dict(failure.trailing_metadata())
    status = status_pb2.Status.FromString(trailing["grpc-status-details-bin"])
    info = error_details_pb2.ErrorInfo()
    assert status.details[0].Unpack(info)
    assert info.domain == "partuv"
    return failure.code(), info.reason
