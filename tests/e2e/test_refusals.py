"""Hostile and odd uploads: the outcome is named, and the next job is served."""

import csv
from pathlib import Path

import grpc
import httpx
import pytest
from partuv_contract.pb import unwrap_pb2 as pb
from partuv_contract.problem import error_kinds
from partuv_service.rpc.unwrap_pb2_grpc import UnwrapStub

from tests.support.follow import GLB, ended, submit
from tests.support.glb_builder import tetrahedron
from tests.support.meshes import quick
from tests.support.rpc import messages, reason
from tests.support.service import Gateway

CORPUS = Path(__file__).resolve().parents[2].parent / "shared" / "meshes" / "malformed"
MANIFEST = CORPUS / "MANIFEST.csv"


def outcome(http: httpx.Client, content: bytes) -> str:
    """`accepted`, or the code of the problem, wherever it was found."""
    answer = http.post("/v1/unwrap", content=content, headers=GLB)
    if answer.status_code != 202:
        assert answer.headers["content-type"] == "application/problem+json"
        assert 400 <= answer.status_code < 500
        return str(answer.json()["code"])
    job = ended(http, answer.json()["id"])
    if job["status"] == "succeeded":
        return "accepted"
    assert job["status"] == "failed"
    assert 400 <= job["error"]["status"] < 500, job["error"]
    assert job["error"]["detail"]
    return str(job["error"]["code"])


def grpc_outcome(stub: UnwrapStub, content: bytes) -> str:
    """The same through gRPC."""
    try:
        job = stub.SubmitUnwrap(messages(content))
    except grpc.RpcError as failure:
        return reason(failure)[1]
    *_, job = stub.WatchJob(pb.WatchJobRequest(id=job.id))
    return "accepted" if job.status == pb.JOB_STATUS_SUCCEEDED else str(job.error.code)


BROKEN = {
    "no_triangles": lambda d: d.json["meshes"][0]["primitives"][0].update(mode=1),
    "malformed_glb": lambda d: d.json["accessors"][0].update(count=1000),
    "unsupported_feature": lambda d: d.json.update(extensionsRequired=["ACME_unheard_of"]),
    "external_uri": lambda d: d.json.update(buffers=[{"byteLength": 96, "uri": "http://x/y"}]),
}


@pytest.mark.parametrize("code", BROKEN)
def test_what_is_wrong_is_named(http: httpx.Client, code: str) -> None:
    document = tetrahedron()
    BROKEN[code](document)
    assert outcome(http, document.build()) == code
    assert ended(http, submit(http, quick(50)))["status"] == "succeeded"


@pytest.mark.skipif(not MANIFEST.is_file(), reason="the corpus of malformed files is not here")
def test_every_malformed_file_meets_its_fate(http: httpx.Client, gateway: Gateway) -> None:
    with MANIFEST.open() as stream:
        rows = [(row["file"], row["expect"]) for row in csv.DictReader(stream)]
    wrong = []
    with grpc.insecure_channel(f"127.0.0.1:{gateway.grpc_port}") as channel:
        stub = UnwrapStub(channel)
        for name, expected in rows:
            content = (CORPUS / name).read_bytes()
            rest, rpc = outcome(http, content), grpc_outcome(stub, content)
            known = rest == "accepted" or rest in error_kinds()
            as_stated = expected == "either" or (rest == "accepted") == (expected == "accept")
            if not (known and as_stated and rest == rpc):
                wrong.append((name, expected, rest, rpc))
    assert wrong == []
    assert ended(http, submit(http, quick(51)))["status"] == "succeeded"
