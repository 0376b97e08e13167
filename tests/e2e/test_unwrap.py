"""GLBs unwrapped through the service."""

import hashlib
import json
import time
import xml.etree.ElementTree as ElementTree

import grpc
import httpx
import numpy as np
import pytest
from partuv_client import PartUV
from partuv_contract.pb import unwrap_pb2 as pb
from partuv_service.rpc.unwrap_pb2_grpc import UnwrapStub
from prometheus_client.parser import text_string_to_metric_families

from tests.support.atlas import least_gutter
from tests.support.children import children_of
from tests.support.follow import GLB, ended, look, running, submit
from tests.support.glb_parse import ParsedGlb
from tests.support.meshes import quick, slow
from tests.support.patches import patch_builder, patches
from tests.support.service import Gateway, Process, until


def test_a_mesh_comes_back_with_an_atlas(http: httpx.Client) -> None:
    source = quick(1)
    job = ended(http, submit(http, source))
    assert job["status"] == "succeeded", job["error"]
    assert job["report"]["faces"] == job["input"]["faces"] > 100
    assert job["report"]["chart_count"] >= 1
    answer = http.get(job["links"]["result"])
    assert answer.headers["etag"] == f'"{hashlib.sha256(answer.content).hexdigest()}"'
    uv = ParsedGlb(answer.content).corners("TEXCOORD_0")
    assert len(uv) == job["report"]["faces"]
    assert np.isfinite(uv).all()
    assert (uv >= 0).all()
    assert (uv <= 1).all()
    assert http.get(job["links"]["preview"]).content.startswith(b"\x89PNG")
    svg = ElementTree.fromstring(http.get(job["links"]["atlas"]).content)
    paths = svg.findall("{http://www.w3.org/2000/svg}path")
    assert len(paths) == job["report"]["chart_count"]


def test_parts_can_be_asked_for(http: httpx.Client) -> None:
    assert ended(http, submit(http, quick(40)))["links"]["parts"] is None
    job = ended(http, submit(http, quick(40), parts="3"))
    assert [part["id"] for part in job["report"]["parts"]] == [0, 1, 2]
    coloured = ParsedGlb(http.get(job["links"]["parts"]).content)
    faces_of_part = np.bincount(coloured.corners("_PART")[:, 0, 0].astype(int))
    assert faces_of_part.tolist() == [part["faces"] for part in job["report"]["parts"]]


def test_charts_can_be_kept_and_packed_anew(http: httpx.Client) -> None:
    made = patches(5, 6)
    source = patch_builder(made).build()
    job = ended(http, submit(http, source, mode="repack", gutter_texels=8, resolution=512))
    assert job["status"] == "succeeded", job["error"]
    assert job["options"]["mode"] == job["report"]["mode"] == "repack"
    assert job["report"]["chart_count"] == 6
    result = ParsedGlb(http.get(job["links"]["result"]).content)
    assert (result.corners("TEXCOORD_1") == made.uv).all()
    assert least_gutter(result.corners("TEXCOORD_0").astype(float), made.chart) >= 8 / 512
    svg = ElementTree.fromstring(http.get(job["links"]["atlas"]).content)
    assert len(svg.findall("{http://www.w3.org/2000/svg}path")) == 6

    refused = ended(http, submit(http, quick(1), mode="repack"))
    assert refused["status"] == "failed"
    assert refused["error"]["code"] == "unusable_uv"
    assert refused["error"]["errors"][0]["pointer"] == "/meshes/0/primitives/0"


def test_one_call_waits_for_the_file(http: httpx.Client) -> None:
    headers = GLB | {"Prefer": "wait=60", "Accept": "model/gltf-binary"}
    answer = http.post("/unwrap", content=quick(2), headers=headers, follow_redirects=True)
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "model/gltf-binary"
    assert "TEXCOORD_0" in ParsedGlb(answer.content).primitive()["attributes"]


def test_the_same_again_is_the_same_at_once(http: httpx.Client) -> None:
    first = ended(http, submit(http, quick(3)))
    started = time.monotonic()
    again = look(http, submit(http, quick(3)))
    assert (again["status"], again["cached"]) == ("succeeded", True)
    assert time.monotonic() - started < 2.0
    contents = [http.get(job["links"]["result"]).content for job in (first, again)]
    assert contents[0] == contents[1]
    http.delete(first["links"]["self"])
    http.delete(again["links"]["self"])
    anew = ended(http, submit(http, quick(3)))
    assert not anew["cached"]
    assert http.get(anew["links"]["result"]).content == contents[0], "made twice, the same bytes"


def test_grpc_gives_what_rest_gives(http: httpx.Client, gateway: Gateway) -> None:
    source = quick(4)
    with grpc.insecure_channel(f"127.0.0.1:{gateway.grpc_port}") as channel:
        stub = UnwrapStub(channel)
        request = pb.SubmitUnwrapRequest(request=pb.UnwrapRequest())
        job = stub.SubmitUnwrap(iter([request, pb.SubmitUnwrapRequest(chunk=source)]))
        *_, job = stub.WatchJob(pb.WatchJobRequest(id=job.id))
        assert job.status == pb.JOB_STATUS_SUCCEEDED
        _, *chunks = stub.DownloadResult(pb.DownloadResultRequest(id=job.id))
    ours = b"".join(message.chunk for message in chunks)
    rest = look(http, submit(http, source))
    assert rest["cached"]
    assert http.get(rest["links"]["result"]).content == ours


def test_the_client_follows_real_progress(gateway: Gateway) -> None:
    seen = []
    with PartUV(gateway.url) as client:
        client.unwrap(slow(5), deadline_s=4, on_progress=seen.append)
    progress = [job.progress for job in seen]
    assert progress == sorted(progress)
    assert progress[-1] == 1.0
    assert len(set(progress)) > 3
    assert len({job.stage for job in seen if job.stage}) >= 2


def test_a_deadline_gives_a_result_that_is_not_for_the_cache(http: httpx.Client) -> None:
    first = ended(http, submit(http, slow(6), deadline_s=1))
    assert first["status"] == "succeeded", first["error"]
    again_id = submit(http, slow(6), deadline_s=1)
    assert look(http, again_id)["status"] != "succeeded"
    http.delete(f"/v1/jobs/{again_id}")


def test_cancel_stops_a_running_engine_soon(http: httpx.Client) -> None:
    job_id = submit(http, slow(7))
    running(http, job_id, past=0.05)
    started = time.monotonic()
    http.post(f"/v1/jobs/{job_id}/cancel")
    job = ended(http, job_id, 10.0)
    assert job["status"] == "canceled"
    assert job["started_at"] is not None
    assert time.monotonic() - started < 5.0, "a second on an idle machine"
    assert ended(http, submit(http, quick(8)))["status"] == "succeeded"


def test_delete_stops_a_running_engine(http: httpx.Client, worker: Process) -> None:
    job_id = submit(http, slow(9))
    running(http, job_id)
    assert http.delete(f"/v1/jobs/{job_id}").status_code == 204
    assert http.get(f"/v1/jobs/{job_id}").status_code == 404
    until(lambda: http.get("/readyz").json()["running"] == 0)
    until(lambda: f'"job_id": "{job_id}"' in _events(worker, "job is no longer ours"))


def _events(process: Process, event: str) -> str:
    return "\n".join(line for line in process.log.read_text().splitlines() if event in line)


def test_request_ids_reach_the_worker(http: httpx.Client, worker: Process) -> None:
    headers = GLB | {"X-Request-ID": "from-afar", "Prefer": "wait=60"}
    job = http.post("/v1/unwrap", content=quick(10), headers=headers).json()

    def lines() -> list[dict]:
        return [json.loads(line) for line in _events(worker, "from-afar").splitlines()]

    until(lambda: {line["event"] for line in lines()} >= {"started", "ended"})
    assert {line["job_id"] for line in lines()} == {job["id"]}


def test_metrics_tell_of_the_work(http: httpx.Client) -> None:
    ended(http, submit(http, quick(11)))
    samples = [
        sample
        for family in text_string_to_metric_families(http.get("/metrics").text)
        for sample in family.samples
    ]
    counts = {(s.name, s.labels.get("stage")): s.value for s in samples}
    assert counts["uv_mesh_faces_count", None] >= 1
    assert counts["uv_job_duration_seconds_count", "packing"] >= 1
    assert counts["uv_worker_slots", None] == 2


def test_only_children_load_the_engine(worker: Process) -> None:
    def libraries(pid: int) -> str:
        with open(f"/proc/{pid}/maps") as maps:
            return maps.read()

    assert "partuv_engine" not in libraries(worker.pid)
    assert all("partuv_engine" in libraries(pid) for pid in children_of(worker.pid))


@pytest.mark.parametrize("name", ["PARTUV_REDIS_URL", "REDIS_URL"])
def test_children_know_no_address_of_the_store(worker: Process, name: str) -> None:
    for pid in children_of(worker.pid):
        with open(f"/proc/{pid}/environ") as environment:
            assert name not in environment.read()
