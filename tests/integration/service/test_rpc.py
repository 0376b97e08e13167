"""The gRPC interface: every call, and the same errors as REST."""

import json
import threading
import time
from collections.abc import Iterator

import grpc
import httpx
import pytest
from grpc_health.v1 import health_pb2, health_pb2_grpc
from grpc_reflection.v1alpha import reflection_pb2, reflection_pb2_grpc
from partuv_contract.pb import unwrap_pb2 as pb
from partuv_service.callers import new_key
from partuv_service.rpc.unwrap_pb2_grpc import UnwrapStub

from tests.support.hand_worker import FILES, HandWorker
from tests.support.rpc import messages, reason
from tests.support.service import Gateway, Stack
from tests.support.uploads import some_glb


@pytest.fixture(scope="module")
def channel(gateway: Gateway) -> Iterator[grpc.Channel]:
    with grpc.insecure_channel(f"127.0.0.1:{gateway.grpc_port}") as channel:
        yield channel


@pytest.fixture
def stub(channel: grpc.Channel) -> UnwrapStub:
    return UnwrapStub(channel)


def test_a_job_from_submit_to_download(stub: UnwrapStub, worker: HandWorker) -> None:
    content = some_glb(450_000)
    options = pb.UnwrapOptions(
        resolution=2048, denoise="0.25", profile="conformal", only=["a", "b"]
    )
    job = stub.SubmitUnwrap(messages(content, options=options))
    assert job.status == pb.JOB_STATUS_QUEUED
    assert (job.input.bytes, job.queue_position > 0) == (len(content), True)
    assert (job.options.resolution, job.options.denoise) == (2048, "0.25")
    assert (job.options.gutter_texels, list(job.options.only)) == (4.0, ["a", "b"])
    worker.succeed(job.id)
    job = stub.GetJob(pb.GetJobRequest(id=job.id))
    assert job.status == pb.JOB_STATUS_SUCCEEDED
    assert job.report["chart_count"] == 3
    assert job.expires_at.ToDatetime() > job.finished_at.ToDatetime()
    first, *rest = stub.DownloadResult(pb.DownloadResultRequest(id=job.id))
    assert first.description.bytes == len(FILES["glb"])
    assert b"".join(message.chunk for message in rest) == FILES["glb"]
    wanted = pb.DownloadResultRequest(id=job.id, file="FILE_PREVIEW_PNG")
    assert list(stub.DownloadResult(wanted))[1].chunk == FILES["png"]


def test_rest_and_grpc_see_the_same_job(stub: UnwrapStub, http: httpx.Client) -> None:
    job = stub.SubmitUnwrap(messages(some_glb()))
    seen = http.get(f"/v1/jobs/{job.id}").json()
    assert seen["input"]["sha256"] == job.input.sha256
    assert seen["options"]["resolution"] == job.options.resolution


def test_watching_ends_with_the_job(stub: UnwrapStub, worker: HandWorker) -> None:
    job = stub.SubmitUnwrap(messages(some_glb()))
    ending = threading.Timer(0.3, lambda: worker.fail(job.id))
    ending.start()
    seen = list(stub.WatchJob(pb.WatchJobRequest(id=job.id)))
    ending.join()
    assert seen[0].status == pb.JOB_STATUS_QUEUED
    assert seen[-1].status == pb.JOB_STATUS_FAILED
    assert seen[-1].error.code == "malformed_glb"
    assert seen[-1].error.errors[0].pointer == "/accessors/0"


def test_cancel_and_forget(stub: UnwrapStub) -> None:
    job = stub.SubmitUnwrap(messages(some_glb()))
    assert stub.CancelJob(pb.CancelJobRequest(id=job.id)).status == pb.JOB_STATUS_CANCELED
    stub.CancelJob(pb.CancelJobRequest(id=job.id, forget=True))
    with pytest.raises(grpc.RpcError) as failure:
        stub.GetJob(pb.GetJobRequest(id=job.id))
    assert reason(failure.value) == (grpc.StatusCode.NOT_FOUND, "job_not_found")


def test_the_same_idempotency_key_gives_the_same_job(stub: UnwrapStub) -> None:
    content = some_glb()
    ids = {stub.SubmitUnwrap(messages(content, idempotency_key="grpc-1")).id for _ in range(3)}
    assert len(ids) == 1
    with pytest.raises(grpc.RpcError) as failure:
        stub.SubmitUnwrap(messages(some_glb(), idempotency_key="grpc-1"))
    assert reason(failure.value) == (grpc.StatusCode.INVALID_ARGUMENT, "idempotency_key_reused")


@pytest.mark.parametrize(
    ("content", "request_", "status", "code"),
    [
        (b"not a mesh, not at all", {}, "INVALID_ARGUMENT", "not_glb"),
        (b"", {}, "INVALID_ARGUMENT", "not_glb"),
        (some_glb()[:-1], {}, "INVALID_ARGUMENT", "malformed_glb"),
        (bytes(2_100_000), {}, "INVALID_ARGUMENT", "not_glb"),
        (some_glb(2_100_000), {}, "RESOURCE_EXHAUSTED", "upload_too_large"),
        (
            some_glb(),
            {"options": pb.UnwrapOptions(resolution=3)},
            "INVALID_ARGUMENT",
            "invalid_option",
        ),
        (some_glb(), {"retention_s": 10**8}, "INVALID_ARGUMENT", "invalid_parameter"),
        (some_glb(), {"webhook_url": "https://a.b/"}, "INVALID_ARGUMENT", "webhook_refused"),
    ],
    ids=["junk", "empty", "cut", "zeros", "large", "option", "retention", "webhook"],
)
def test_refusals(stub: UnwrapStub, content: bytes, request_: dict, status: str, code: str) -> None:
    with pytest.raises(grpc.RpcError) as failure:
        stub.SubmitUnwrap(messages(content, **request_))
    assert reason(failure.value) == (grpc.StatusCode[status], code)


def test_streams_out_of_order_are_refused(stub: UnwrapStub) -> None:
    for stream in ([], [pb.SubmitUnwrapRequest(chunk=some_glb())], [*messages(b"")] * 2):
        with pytest.raises(grpc.RpcError) as failure:
            stub.SubmitUnwrap(iter(stream))
        assert reason(failure.value) == (grpc.StatusCode.INVALID_ARGUMENT, "malformed_request")


def test_a_client_that_falls_silent_is_given_up(stub: UnwrapStub) -> None:
    def stalled() -> Iterator[pb.SubmitUnwrapRequest]:
        yield from messages(some_glb()[:50])
        time.sleep(4.0)

    with pytest.raises(grpc.RpcError) as failure:
        stub.SubmitUnwrap(stalled())
    assert reason(failure.value) == (grpc.StatusCode.INVALID_ARGUMENT, "malformed_request")


def test_before_the_end_there_is_no_result(stub: UnwrapStub) -> None:
    job = stub.SubmitUnwrap(messages(some_glb()))
    with pytest.raises(grpc.RpcError) as failure:
        list(stub.DownloadResult(pb.DownloadResultRequest(id=job.id)))
    assert reason(failure.value) == (grpc.StatusCode.FAILED_PRECONDITION, "result_not_ready")


def test_messages_stay_below_a_mebibyte(stub: UnwrapStub) -> None:
    with pytest.raises(grpc.RpcError) as failure:
        stub.SubmitUnwrap(messages(some_glb(1_500_000), chunk=1_400_000))
    assert failure.value.code() == grpc.StatusCode.RESOURCE_EXHAUSTED


def test_request_ids_are_echoed(stub: UnwrapStub) -> None:
    call = stub.GetJob.with_call
    job = stub.SubmitUnwrap(messages(some_glb()))
    _, answer = call(pb.GetJobRequest(id=job.id), metadata=(("x-request-id", "r-1"),))
    assert dict(answer.initial_metadata())["x-request-id"] == "r-1"


def test_health_and_reflection(channel: grpc.Channel) -> None:
    health = health_pb2_grpc.HealthStub(channel)
    for name in ("", "partuv.v1.Unwrap"):
        answer = health.Check(health_pb2.HealthCheckRequest(service=name))
        assert answer.status == health_pb2.HealthCheckResponse.SERVING
    reflection = reflection_pb2_grpc.ServerReflectionStub(channel)
    ask = reflection_pb2.ServerReflectionRequest(list_services="")
    (answer,) = reflection.ServerReflectionInfo(iter([ask]))
    names = {service.name for service in answer.list_services_response.service}
    assert {"partuv.v1.Unwrap", "grpc.health.v1.Health"} <= names


def test_keys_count_here_too(stack: Stack) -> None:
    (anna, anna_digest), (bert, bert_digest) = new_key(), new_key()
    keys = json.dumps({"anna": anna_digest, "bert": bert_digest})
    guarded = stack.gateway(api_keys=keys, key_prefix="rpc:")
    with grpc.insecure_channel(f"127.0.0.1:{guarded.grpc_port}") as channel:
        stub = UnwrapStub(channel)
        with pytest.raises(grpc.RpcError) as failure:
            stub.SubmitUnwrap(messages(some_glb()))
        assert reason(failure.value) == (grpc.StatusCode.UNAUTHENTICATED, "unauthorized")
        mine, theirs = (("authorization", f"Bearer {anna}"),), (("x-api-key", bert),)
        job = stub.SubmitUnwrap(messages(some_glb()), metadata=mine)
        assert stub.GetJob(pb.GetJobRequest(id=job.id), metadata=mine).id == job.id
        calls = [
            lambda: stub.GetJob(pb.GetJobRequest(id=job.id), metadata=theirs),
            lambda: list(stub.WatchJob(pb.WatchJobRequest(id=job.id), metadata=theirs)),
            lambda: stub.CancelJob(pb.CancelJobRequest(id=job.id), metadata=theirs),
            lambda: list(stub.DownloadResult(pb.DownloadResultRequest(id=job.id), metadata=theirs)),
        ]
        for call in calls:
            with pytest.raises(grpc.RpcError) as failure:
                call()
            assert reason(failure.value) == (grpc.StatusCode.NOT_FOUND, "job_not_found")
    guarded.stop()
