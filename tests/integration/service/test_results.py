"""Results fetched whole, in part, and not again."""

import hashlib

import httpx
import pytest

from tests.support.hand_worker import FILES, HandWorker
from tests.support.uploads import submit

GLB = FILES["glb"]
SIZE = len(GLB)


@pytest.fixture
def result(http: httpx.Client, worker: HandWorker) -> str:
    job_id = submit(http)
    worker.succeed(job_id)
    return f"/v1/jobs/{job_id}/result"


def test_before_the_end_there_is_no_result(http: httpx.Client) -> None:
    answer = http.get(f"/v1/jobs/{submit(http)}/result")
    assert (answer.status_code, answer.json()["code"]) == (409, "result_not_ready")
    assert "retry-after" in answer.headers


def test_the_whole_file(http: httpx.Client, result: str) -> None:
    answer = http.get(result)
    assert answer.status_code == 200
    assert answer.content == GLB
    assert answer.headers["content-type"] == "model/gltf-binary"
    assert answer.headers["etag"] == f'"{hashlib.sha256(GLB).hexdigest()}"'
    assert answer.headers["accept-ranges"] == "bytes"
    assert answer.headers["content-length"] == str(SIZE)
    assert 'filename="job_' in answer.headers["content-disposition"]
    assert "private" in answer.headers["cache-control"]


def test_head_tells_the_same_without_the_body(http: httpx.Client, result: str) -> None:
    head, get = http.head(result), http.get(result)
    ours = {"x-request-id", "date"}
    assert head.content == b""
    assert {k: v for k, v in head.headers.items() if k not in ours} == {
        k: v for k, v in get.headers.items() if k not in ours
    }


@pytest.mark.parametrize(
    ("asked", "first", "last"),
    [
        ("bytes=0-0", 0, 0),
        ("bytes=524280-524300", 524280, 524300),
        ("bytes=100-", 100, SIZE - 1),
        ("bytes=-5", SIZE - 5, SIZE - 1),
        ("bytes=0-99999999999", 0, SIZE - 1),
        ("bytes=-99999999999", 0, SIZE - 1),
    ],
)
def test_a_part(http: httpx.Client, result: str, asked: str, first: int, last: int) -> None:
    answer = http.get(result, headers={"Range": asked})
    assert answer.status_code == 206
    assert answer.content == GLB[first : last + 1]
    assert answer.headers["content-range"] == f"bytes {first}-{last}/{SIZE}"
    assert answer.headers["content-length"] == str(last - first + 1)


@pytest.mark.parametrize(
    "asked", ["bytes=5-2", "bytes=0-1,4-5", "lines=1-2", "bytes=x-y", "bytes=-"]
)
def test_ranges_that_make_no_sense_are_ignored(http: httpx.Client, result: str, asked: str) -> None:
    answer = http.get(result, headers={"Range": asked})
    assert (answer.status_code, len(answer.content)) == (200, SIZE)


@pytest.mark.parametrize("asked", [f"bytes={SIZE}-", "bytes=-0"])
def test_ranges_past_the_end_are_refused(http: httpx.Client, result: str, asked: str) -> None:
    answer = http.get(result, headers={"Range": asked})
    assert (answer.status_code, answer.json()["code"]) == (416, "range_not_satisfiable")
    assert answer.headers["content-range"] == f"bytes */{SIZE}"


def test_if_range_wants_the_same_file(http: httpx.Client, result: str) -> None:
    etag = http.head(result).headers["etag"]
    same = http.get(result, headers={"Range": "bytes=0-9", "If-Range": etag})
    other = http.get(result, headers={"Range": "bytes=0-9", "If-Range": '"other"'})
    assert (same.status_code, other.status_code) == (206, 200)


def test_what_the_client_has_is_not_sent_again(http: httpx.Client, result: str) -> None:
    etag = http.head(result).headers["etag"]
    for tags in (etag, f'"other", W/{etag}', "*"):
        answer = http.get(result, headers={"If-None-Match": tags})
        assert (answer.status_code, answer.content) == (304, b"")
        assert answer.headers["etag"] == etag
    assert http.get(result, headers={"If-None-Match": '"other"'}).status_code == 200


@pytest.mark.parametrize(
    ("name", "kind", "media_type"),
    [
        ("preview.png", "png", "image/png"),
        ("atlas.svg", "svg", "image/svg+xml"),
        ("parts.glb", "parts", "model/gltf-binary"),
    ],
)
def test_drawings(http: httpx.Client, result: str, name: str, kind: str, media_type: str) -> None:
    answer = http.get(result.replace("result", name))
    assert answer.content == FILES[kind]
    assert answer.headers["content-type"].partition(";")[0] == media_type
    assert "default-src 'none'" in answer.headers["content-security-policy"]
