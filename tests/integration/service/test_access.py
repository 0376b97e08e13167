"""Keys, owners and limits, on a gateway that has them all."""

import hashlib
import json
from collections.abc import Iterator

import httpx
import pytest
from partuv_service.callers import new_key

from tests.support.hand_worker import HandWorker
from tests.support.service import Gateway, Stack
from tests.support.uploads import GLB, some_glb, submit

ANNA, ANNA_DIGEST = new_key()
BERT, BERT_DIGEST = new_key()


@pytest.fixture(scope="module")
def guarded(stack: Stack) -> Gateway:
    return stack.gateway(
        api_keys=json.dumps({"anna": ANNA_DIGEST, "bert": BERT_DIGEST}),
        key_prefix="guarded:",
        max_jobs_per_key="2",
        max_queued_jobs="3",
        store_budget_bytes="3000000",
    )


@pytest.fixture
def anna(guarded: Gateway) -> Iterator[httpx.Client]:
    yield from client(guarded, {"Authorization": f"Bearer {ANNA}"})


@pytest.fixture
def bert(guarded: Gateway) -> Iterator[httpx.Client]:
    yield from client(guarded, {"X-API-Key": BERT})


def client(gateway: Gateway, headers: dict[str, str]) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=gateway.url, headers=headers, timeout=20.0) as http:
        yield http


@pytest.fixture
def job_id(anna: httpx.Client) -> Iterator[str]:
    job_id = submit(anna)
    yield job_id
    anna.delete(f"/v1/jobs/{job_id}")


EVERYTHING = [
    ("GET", ""),
    ("DELETE", ""),
    ("POST", "/cancel"),
    ("GET", "/events"),
    ("GET", "/result"),
    ("HEAD", "/result"),
    ("GET", "/preview.png"),
    ("GET", "/atlas.svg"),
    ("GET", "/parts.glb"),
]


@pytest.mark.parametrize(
    "headers",
    [
        {},
        {"Authorization": "Bearer nonsense"},
        {"Authorization": f"Basic {ANNA}"},
        {"Authorization": "Bearer"},
        {"X-API-Key": ANNA_DIGEST},
        {"X-API-Key": ANNA + "x"},
    ],
)
def test_without_a_valid_key_nothing_is_told(
    guarded: Gateway, job_id: str, headers: dict[str, str]
) -> None:
    with httpx.Client(base_url=guarded.url, headers=headers) as http:
        for method, path in EVERYTHING:
            answer = http.request(method, f"/v1/jobs/{job_id}{path}")
            assert answer.status_code == 401
            assert answer.headers["www-authenticate"] == "Bearer"
        answer = http.post("/v1/unwrap", content=some_glb(), headers=GLB)
        assert (answer.status_code, answer.json()["code"]) == (401, "unauthorized")
        assert http.get("/healthz").status_code == 200


def test_other_peoples_jobs_are_not_there(bert: httpx.Client, job_id: str) -> None:
    for method, path in EVERYTHING:
        answer = bert.request(method, f"/v1/jobs/{job_id}{path}")
        assert answer.status_code == 404, path
        if method != "HEAD":
            assert answer.json()["code"] == "job_not_found"


def test_the_job_is_unharmed_by_strangers(anna: httpx.Client, job_id: str) -> None:
    assert anna.get(f"/v1/jobs/{job_id}").json()["status"] == "queued"


def test_idempotency_keys_and_results_are_each_owners(
    anna: httpx.Client, bert: httpx.Client
) -> None:
    content, headers = some_glb(), GLB | {"Idempotency-Key": "same"}
    jobs = [c.post("/v1/unwrap", content=content, headers=headers).json() for c in (anna, bert)]
    assert jobs[0]["id"] != jobs[1]["id"]
    for http, job in zip((anna, bert), jobs, strict=True):
        http.delete(job["links"]["self"])


def test_too_many_jobs_of_one_key(anna: httpx.Client, bert: httpx.Client) -> None:
    mine = [submit(anna), submit(anna)]
    answer = anna.post("/v1/unwrap", content=some_glb(), headers=GLB)
    assert (answer.status_code, answer.json()["code"]) == (429, "too_many_jobs")
    assert int(answer.headers["retry-after"]) >= 1
    theirs = submit(bert)
    answer = bert.post("/v1/unwrap", content=some_glb(), headers=GLB)
    assert (answer.status_code, answer.json()["code"]) == (503, "queue_full")
    assert int(answer.headers["retry-after"]) >= 1
    for job_id in mine:
        anna.delete(f"/v1/jobs/{job_id}")
    bert.delete(f"/v1/jobs/{theirs}")


def test_a_full_store_refuses_uploads(anna: httpx.Client) -> None:
    first = anna.post("/v1/unwrap", content=some_glb(2_000_000), headers=GLB).json()
    by_header = anna.post("/v1/unwrap", content=some_glb(2_000_000), headers=GLB)
    pieces = iter([some_glb(2_000_000)])
    by_count = anna.post("/v1/unwrap", content=pieces, headers=GLB)
    for answer in (by_header, by_count):
        assert (answer.status_code, answer.json()["code"]) == (503, "store_full")
        assert int(answer.headers["retry-after"]) >= 1
    anna.delete(first["links"]["self"])
    again = anna.post("/v1/unwrap", content=some_glb(2_000_000), headers=GLB)
    assert again.status_code == 202
    anna.delete(again.json()["links"]["self"])


def test_the_request_rate_is_limited_per_key(stack: Stack) -> None:
    keys = json.dumps({"anna": ANNA_DIGEST, "bert": BERT_DIGEST})
    gateway = stack.gateway(
        api_keys=keys, key_prefix="slow:", rate_limit_per_minute="60", rate_limit_burst="5"
    )
    with httpx.Client(base_url=gateway.url) as http:
        asked = [http.get("/v1/jobs/x", headers={"X-API-Key": ANNA}) for _ in range(8)]
        assert [answer.status_code for answer in asked[:5]] == [404] * 5
        assert asked[-1].status_code == 429
        assert asked[-1].json()["code"] == "rate_limited"
        assert int(asked[-1].headers["retry-after"]) >= 1
        assert http.get("/v1/jobs/x", headers={"X-API-Key": BERT}).status_code == 404
    gateway.stop()


def test_no_key_is_ever_logged(guarded: Gateway, anna: httpx.Client) -> None:
    anna.get("/v1/jobs/x", params={"X-API-Key": "in-the-query"})
    text = guarded.log.read_text()
    for secret in (ANNA, BERT, hashlib.sha256(ANNA.encode()).hexdigest(), "in-the-query"):
        assert secret not in text


def test_a_gateway_without_keys_stays_on_this_machine(stack: Stack) -> None:
    from tests.support.service import Process

    gateway = Process(
        "partuv_service", stack.environment(host="0.0.0.0"), stack.folder / "open.log"
    )
    assert gateway._process.wait(20.0) == 2
    assert "API keys" in gateway.log.read_text()


def test_the_owner_is_the_keys_name_not_the_key(
    anna: httpx.Client, job_id: str, stack: Stack, worker: HandWorker
) -> None:
    import redis

    with redis.Redis.from_url(stack.redis.url) as raw:
        assert raw.hget(f"guarded:job:{job_id}", "owner") == b"key:anna"
        everything = b"".join(raw.keys("*")) + b"".join(raw.hvals(f"guarded:job:{job_id}"))
    assert ANNA.encode() not in everything
