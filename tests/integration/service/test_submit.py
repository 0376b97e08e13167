"""POST /v1/unwrap: every way in, and every way to be refused."""

import base64
import json
import socket
import threading
from collections.abc import Iterator

import httpx
import pytest
import redis
from partuv_store import blobs, execution

from tests.support.hand_worker import HandWorker
from tests.support.service import Gateway, Stack, until
from tests.support.uploads import GLB, some_glb, submit


def refused(answer: httpx.Response, status: int, code: str) -> dict:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert (problem["status"], problem["code"]) == (status, code)
    assert problem["type"] == f"urn:partuv:problem:{code}"
    assert problem["title"]
    assert problem["detail"]
    return problem


@pytest.mark.parametrize("path", ["/v1/unwrap", "/unwrap"])
def test_a_glb_becomes_a_job(http: httpx.Client, path: str) -> None:
    content = some_glb()
    answer = http.post(path, content=content, headers=GLB, params={"resolution": 512})
    assert answer.status_code == 202
    job = answer.json()
    assert answer.headers["location"] == f"/v1/jobs/{job['id']}" == job["links"]["self"]
    assert int(answer.headers["retry-after"]) >= 1
    assert job["status"] == "queued"
    assert job["queue_position"] >= 1
    assert job["options"]["resolution"] == 512
    assert job["options"]["gutter_texels"] == 4.0, "defaults are filled in"
    assert job["input"]["bytes"] == len(content)
    assert job["expires_at"] > job["created_at"]
    assert http.get(job["links"]["self"]).json()["id"] == job["id"]


def test_a_form_is_the_same(http: httpx.Client) -> None:
    content = some_glb()
    answer = http.post(
        "/v1/unwrap",
        files={"file": ("a mesh.glb", content, "model/gltf-binary")},
        data={"resolution": "2048", "denoise": "0.5"},
        params={"gutter_texels": "2"},
    )
    assert answer.status_code == 202, answer.text
    job = answer.json()
    assert job["input"]["bytes"] == len(content)
    chosen = {name: job["options"][name] for name in ("resolution", "denoise", "gutter_texels")}
    assert chosen == {"resolution": 2048, "denoise": 0.5, "gutter_texels": 2.0}


def test_the_upload_is_what_the_worker_gets(http: httpx.Client, worker: HandWorker) -> None:
    content = some_glb(3 * blobs.CHUNK_BYTES // 2)
    job = http.post("/v1/unwrap", files={"file": content}).json()
    name = blobs.upload_name(job["id"])
    assert worker.store.read_chunk(name, 0) + worker.store.read_chunk(name, 1) == content


def test_a_body_without_a_length_is_read_as_well(http: httpx.Client) -> None:
    content = some_glb(300_000)
    pieces = (content[start : start + 9999] for start in range(0, len(content), 9999))
    answer = http.post("/v1/unwrap", content=pieces, headers=GLB)
    assert answer.status_code == 202
    assert answer.json()["input"]["bytes"] == len(content)


@pytest.mark.parametrize(
    ("parameters", "code", "pointer"),
    [
        ({"resolution": "1"}, "invalid_option", "/resolution"),
        ({"resolution": "many"}, "invalid_option", "/resolution"),
        ({"max_area_distortion": "nan"}, "invalid_option", "/max_area_distortion"),
        ({"colour": "red"}, "invalid_option", "/colour"),
        ({"retention_s": "0"}, "invalid_parameter", "/retention_s"),
        ({"retention_s": "99999999"}, "invalid_parameter", "/retention_s"),
        ({"retention_s": "-1"}, "invalid_parameter", "/retention_s"),
        ({"webhook_url": "https://example.org/"}, "webhook_refused", "/webhook_url"),
    ],
)
@pytest.mark.parametrize("way", ["query", "form"])
def test_bad_parameters_are_named(
    http: httpx.Client, parameters: dict, code: str, pointer: str, way: str
) -> None:
    if way == "query":
        answer = http.post("/v1/unwrap", content=some_glb(), headers=GLB, params=parameters)
    else:
        answer = http.post("/v1/unwrap", files={"file": some_glb()}, data=parameters)
    problem = refused(answer, 422, code)
    assert [error["pointer"] for error in problem["errors"]] == [pointer]


@pytest.mark.parametrize(
    ("content", "status", "code"),
    [
        (b"", 415, "not_glb"),
        (b"glTF", 415, "not_glb"),
        (b"solid " + bytes(100), 415, "not_glb"),
        (b"glTF\x01\x00\x00\x00" + bytes(100), 415, "not_glb"),
        (some_glb()[:-1], 422, "malformed_glb"),
    ],
    ids=["empty", "short", "other", "version-1", "cut"],
)
@pytest.mark.parametrize("way", ["raw", "form"])
def test_what_is_no_glb_is_refused(
    http: httpx.Client, content: bytes, status: int, code: str, way: str
) -> None:
    if way == "raw":
        answer = http.post("/v1/unwrap", content=content, headers=GLB)
    else:
        answer = http.post("/v1/unwrap", files={"file": content})
    refused(answer, status, code)


def test_other_media_types_are_refused(http: httpx.Client) -> None:
    headers = {"Content-Type": "application/x-www-form-urlencoded"}
    answer = http.post("/v1/unwrap", content=some_glb(), headers=headers)
    refused(answer, 415, "unsupported_media_type")


def multipart(*parts: tuple[str, bytes]) -> bytes:
    body = b"".join(
        b'--X\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n' % (name.encode(), content)
        for name, content in parts
    )
    return body + b"--X--\r\n"


@pytest.mark.parametrize(
    ("body", "boundary"),
    [
        (multipart(("resolution", b"512")), "X"),
        (multipart(("file", some_glb()), ("file", some_glb())), "X"),
        (multipart(("file", some_glb()), ("denoise", b"\xff\xfe")), "X"),
        (multipart(("file", some_glb()), ("denoise", bytes(20_000))), "X"),
        (multipart(*[(f"f{number}", b"") for number in range(200)]), "X"),
        (multipart(("file", some_glb()))[:-9], "X"),
        (b"no form at all", "X"),
        (multipart(("file", some_glb())), ""),
    ],
    ids=["no-file", "two-files", "not-utf8", "long", "many", "cut", "junk", "no-boundary"],
)
def test_broken_forms_are_refused(http: httpx.Client, body: bytes, boundary: str) -> None:
    headers = {"Content-Type": f"multipart/form-data; boundary={boundary}"}
    refused(http.post("/v1/unwrap", content=body, headers=headers), 400, "malformed_request")


def test_query_and_form_may_not_contradict(http: httpx.Client) -> None:
    files = {"file": some_glb()}
    answer = http.post(
        "/v1/unwrap", files=files, data={"resolution": "512"}, params={"resolution": "1024"}
    )
    refused(answer, 422, "invalid_parameter")


def test_a_parameter_given_twice_is_refused(http: httpx.Client) -> None:
    answer = http.post("/v1/unwrap?resolution=64&resolution=64", content=some_glb(), headers=GLB)
    refused(answer, 422, "invalid_parameter")
    fields = {"file": some_glb()}
    answer = http.post("/v1/unwrap", files=fields, data={"denoise": ["off", "off"]})
    refused(answer, 422, "invalid_parameter")


@pytest.mark.parametrize("way", ["query", "form"])
def test_lists_are_given_value_by_value(http: httpx.Client, way: str) -> None:
    names = {"only": ["left, wing", "right"]}
    if way == "query":
        answer = http.post("/v1/unwrap", content=some_glb(), headers=GLB, params=names)
    else:
        answer = http.post("/v1/unwrap", files={"file": some_glb()}, data=names)
    assert answer.json()["options"]["only"] == names["only"]


def test_too_large_is_known_from_the_header(gateway: Gateway) -> None:
    """Refused before a byte of the body was sent."""
    with socket.create_connection(("127.0.0.1", gateway.port)) as raw:
        raw.sendall(
            b"POST /v1/unwrap HTTP/1.1\r\nHost: x\r\nContent-Type: model/gltf-binary\r\n"
            b"Content-Length: 2000001\r\n\r\n"
        )
        raw.sendall(some_glb(2000000 // 4 * 4) + b"x")
        assert raw.recv(100).startswith(b"HTTP/1.1 413 ")


def test_too_large_is_noticed_while_reading(http: httpx.Client, stack: Stack) -> None:
    def endless() -> Iterator[bytes]:
        yield some_glb(1_000_000)
        for _ in range(200):
            yield bytes(10_000)

    refused(http.post("/v1/unwrap", content=endless(), headers=GLB), 413, "upload_too_large")


def test_refused_uploads_leave_nothing(http: httpx.Client, stack: Stack) -> None:
    http.post("/v1/unwrap", content=some_glb(1_500_000)[:-1], headers=GLB)
    http.post("/v1/unwrap", files={"file": some_glb(1_500_000)}, data={"resolution": "1"})
    with redis.Redis.from_url(stack.redis.url) as raw:
        jobs = {key.decode().rpartition(":")[2] for key in raw.keys("partuv:job:*")}
        uploads = {key.decode().rpartition(":")[2] for key in raw.keys("partuv:blob:upload:*")}
    assert uploads <= jobs


def test_a_silent_client_is_given_up(gateway: Gateway) -> None:
    with socket.create_connection(("127.0.0.1", gateway.port)) as raw:
        raw.sendall(
            b"POST /v1/unwrap HTTP/1.1\r\nHost: x\r\nContent-Type: model/gltf-binary\r\n"
            b"Content-Length: 100000\r\n\r\nglTF"
        )
        raw.settimeout(10.0)
        assert raw.recv(100).startswith(b"HTTP/1.1 400 ")


def test_the_same_idempotency_key_gives_the_same_job(http: httpx.Client) -> None:
    content = some_glb()
    headers = GLB | {"Idempotency-Key": "key-1"}
    first = http.post("/v1/unwrap", content=content, headers=headers)
    again = http.post("/v1/unwrap", content=content, headers=headers)
    assert again.status_code == 202
    assert again.json()["id"] == first.json()["id"]
    assert again.headers["idempotency-replayed"] == "true"
    assert "idempotency-replayed" not in first.headers
    other = http.post("/v1/unwrap", content=some_glb(), headers=headers)
    refused(other, 422, "idempotency_key_reused")
    options = http.post("/v1/unwrap?resolution=64", content=content, headers=headers)
    refused(options, 422, "idempotency_key_reused")


def test_the_same_key_at_the_same_time_gives_one_job(gateway: Gateway) -> None:
    content, ids = some_glb(500_000), []

    def send() -> None:
        headers = GLB | {"Idempotency-Key": "key-2"}
        answer = httpx.post(f"{gateway.url}/v1/unwrap", content=content, headers=headers)
        ids.append(answer.json()["id"])

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(ids) == 8
    assert len(set(ids)) == 1


def test_prefer_wait_brings_the_finished_job(
    http: httpx.Client, worker: HandWorker, stack: Stack
) -> None:
    done = threading.Thread(target=finish, args=(worker, stack, "wait-1"))
    done.start()
    headers = GLB | {"Prefer": "respond-async, wait=15", "X-Request-ID": "wait-1"}
    answer = http.post("/v1/unwrap", content=some_glb(), headers=headers)
    done.join()
    assert (answer.status_code, answer.json()["status"]) == (200, "succeeded")
    assert answer.json()["report"]["chart_count"] == 3


def finish(worker: HandWorker, stack: Stack, request_id: str, *, fail: bool = False) -> None:
    """Play the worker for the job of a request."""

    def waiting() -> list[str]:
        with redis.Redis.from_url(stack.redis.url, decode_responses=True) as raw:
            ids = raw.zrange("partuv:waiting", 0, -1)
            return [i for i in ids if raw.hget(f"partuv:job:{i}", "request_id") == request_id]

    job_id = until(waiting)[0]
    worker.fail(job_id) if fail else worker.succeed(job_id)


@pytest.mark.parametrize("fail", [False, True])
def test_prefer_wait_and_accept_glb(
    http: httpx.Client, worker: HandWorker, stack: Stack, fail: bool
) -> None:
    done = threading.Thread(
        target=finish, args=(worker, stack, f"wait-{fail}"), kwargs={"fail": fail}
    )
    done.start()
    headers = GLB | {"Prefer": "wait=15", "Accept": "model/gltf-binary"}
    headers |= {"X-Request-ID": f"wait-{fail}"}
    answer = http.post("/v1/unwrap", content=some_glb(), headers=headers)
    done.join()
    if fail:
        problem = refused(answer, 422, "malformed_glb")
        assert problem["instance"].startswith("/v1/jobs/job_")
    else:
        assert answer.status_code == 303
        assert http.get(answer.headers["location"]).content.startswith(b"glTF")


def test_prefer_wait_gives_up_with_202(http: httpx.Client) -> None:
    headers = GLB | {"Prefer": "wait=1"}
    answer = http.post("/v1/unwrap", content=some_glb(), headers=headers)
    assert (answer.status_code, answer.json()["status"]) == (202, "queued")


def test_request_ids_are_echoed_logged_and_travel_with_the_message(
    http: httpx.Client, gateway: Gateway, stack: Stack
) -> None:
    job_id = submit(http, headers={"X-Request-ID": "trace-me-7"})

    def ours() -> list[dict]:
        lines = [json.loads(line) for line in gateway.log.read_text().splitlines()]
        return [line for line in lines if line.get("request_id") == "trace-me-7"]

    until(lambda: {line["event"] for line in ours()} >= {"submitted", "request"})
    assert any(line.get("job_id") == job_id for line in ours())
    with redis.Redis.from_url(stack.redis.url) as raw:
        messages = [json.loads(text) for text in raw.lrange("partuv:mq:unwrap", 0, -1)]
    headers = [message["headers"] for message in messages if message["headers"]["job_id"] == job_id]
    assert [one["request_id"] for one in headers] == ["trace-me-7"]
    assert http.get("/healthz", headers={"X-Request-ID": "no good id"}).headers["x-request-id"] != (
        "no good id"
    )


def test_a_message_holds_nothing_but_ids(http: httpx.Client, stack: Stack) -> None:
    job_id = submit(http)
    with redis.Redis.from_url(stack.redis.url) as raw:
        bodies = [json.loads(text)["body"] for text in raw.lrange("partuv:mq:unwrap", 0, -1)]
    arguments = [json.loads(base64.b64decode(body))[:2] for body in bodies]
    assert [[job_id], {}] in arguments


def test_cached_results_are_answered_at_once(http: httpx.Client, worker: HandWorker) -> None:
    worker.store.run(execution.announce("w", {}, "build-1"))
    content = some_glb()
    first = http.post("/v1/unwrap", content=content, headers=GLB).json()
    worker.succeed(first["id"], build="build-1")
    again = http.post("/v1/unwrap", content=content, headers=GLB)
    assert (again.status_code, again.json()["status"]) == (202, "succeeded")
    assert again.json()["cached"]
    assert again.json()["id"] != first["id"]
    other = http.post("/v1/unwrap?resolution=512", content=content, headers=GLB)
    assert other.json()["status"] == "queued", "other options, other result"
    http.delete(first["links"]["self"])
    assert http.get(again.json()["links"]["result"]).content.startswith(b"glTF")
