"""Webhooks: signed, retried, logged, and never sent to where they must not go."""

import base64
import json
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
import redis
from partuv_store import Store
from standardwebhooks import Webhook, WebhookVerificationError

from tests.support.hand_worker import HandWorker
from tests.support.receiver import Receiver
from tests.support.service import Gateway, Stack, until
from tests.support.uploads import GLB, some_glb

NEW, OLD = ("whsec_" + base64.b64encode(bytes([n]) * 32).decode() for n in (1, 2))
PREFIX = "hooks:"


@pytest.fixture(scope="module")
def ca_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("ca") / "ca.pem"


@pytest.fixture(scope="module")
def listening(ca_file: Path) -> Iterator[Receiver]:
    receiver = Receiver(ca_file)
    yield receiver
    receiver.close()


@pytest.fixture
def receiver(listening: Receiver) -> Receiver:
    listening.answers.clear()
    listening.deliveries.clear()
    return listening


@pytest.fixture(scope="module")
def gateway(stack: Stack, listening: Receiver, ca_file: Path) -> Gateway:
    return stack.gateway(
        key_prefix=PREFIX,
        webhook_secrets=json.dumps([NEW, OLD]),
        webhook_networks='["127.0.0.0/8", "::1/128"]',
        webhook_ca_file=str(ca_file),
        webhook_retry_delays_s="[0.2, 0.2]",
    )


@pytest.fixture
def worker(stack: Stack) -> Iterator[HandWorker]:
    store = Store(stack.redis.url, prefix=PREFIX)
    yield HandWorker(store)
    store.close()


def submit(http: httpx.Client, url: str) -> str:
    answer = http.post("/v1/unwrap", content=some_glb(), headers=GLB, params={"webhook_url": url})
    assert answer.status_code == 202, answer.text
    return answer.json()["id"]


def deliveries(http: httpx.Client, job_id: str, count: int) -> list[dict]:
    def told() -> list[dict]:
        log = http.get(f"/v1/jobs/{job_id}").json()["webhook_deliveries"]
        return log if len(log) >= count else []

    return until(told)


@pytest.mark.parametrize("ending", ["succeeded", "failed", "canceled"])
def test_every_ending_is_told_and_signed(
    http: httpx.Client, worker: HandWorker, receiver: Receiver, ending: str
) -> None:
    job_id = submit(http, f"{receiver.url}/hook?who=me")
    if ending == "succeeded":
        worker.succeed(job_id)
    elif ending == "failed":
        worker.fail(job_id)
    else:
        http.post(f"/v1/jobs/{job_id}/cancel")
    (log,) = deliveries(http, job_id, 1)
    assert (log["delivered"], log["status"], log["attempt"]) == (True, 204, 1)
    (delivery,) = receiver.deliveries
    assert delivery.path == "/hook?who=me"
    assert delivery.headers["Host"] == receiver.url.removeprefix("https://")
    for secret in (NEW, OLD):
        message = Webhook(secret).verify(delivery.body.decode(), delivery.headers)
        assert message["type"] == f"job.{ending}"
        assert (message["data"]["id"], message["data"]["status"]) == (job_id, ending)
    stranger = Webhook("whsec_" + base64.b64encode(bytes(32)).decode())
    with pytest.raises(WebhookVerificationError):
        stranger.verify(delivery.body.decode(), delivery.headers)


def test_a_refusal_is_tried_again_with_the_same_id(
    http: httpx.Client, worker: HandWorker, receiver: Receiver
) -> None:
    receiver.answers += [500, 429]
    job_id = submit(http, f"{receiver.url}/")
    worker.succeed(job_id)
    log = deliveries(http, job_id, 3)
    assert [(one["status"], one["delivered"]) for one in log] == [
        (500, False),
        (429, False),
        (204, True),
    ]
    assert {delivery.headers["webhook-id"] for delivery in receiver.deliveries} == {job_id}
    assert len(receiver.deliveries) == 3


def test_it_gives_up_in_the_end(
    http: httpx.Client, worker: HandWorker, receiver: Receiver, stack: Stack
) -> None:
    receiver.answers += [500] * 9
    job_id = submit(http, f"{receiver.url}/")
    worker.succeed(job_id)
    assert len(deliveries(http, job_id, 3)) == 3
    with redis.Redis.from_url(stack.redis.url) as raw:
        assert raw.zscore(f"{PREFIX}webhooks", job_id) is None


def test_redirects_are_not_followed(
    http: httpx.Client, worker: HandWorker, receiver: Receiver
) -> None:
    receiver.answers += [307]
    job_id = submit(http, f"{receiver.url}/")
    worker.succeed(job_id)
    first, second = deliveries(http, job_id, 2)[:2]
    assert (first["status"], first["delivered"]) == (307, False)
    assert second["delivered"]
    assert [delivery.path for delivery in receiver.deliveries] == ["/", "/"]


def test_a_certificate_of_somebody_else_is_not_trusted(
    http: httpx.Client, worker: HandWorker, tmp_path: Path
) -> None:
    stranger = Receiver(tmp_path / "other.pem")
    job_id = submit(http, f"{stranger.url}/")
    worker.succeed(job_id)
    log = deliveries(http, job_id, 1)
    assert not log[0]["delivered"]
    assert "certificate" in log[0]["error"].lower()
    assert stranger.deliveries == []
    stranger.close()


@pytest.mark.parametrize(
    "url",
    [
        "https://10.0.0.1/",
        "https://169.254.169.254/latest/meta-data",
        "https://[fe80::1]/",
        "http://example.org/",
        "https://user:secret@example.org/",
        "file:///etc/passwd",
    ],
)
def test_addresses_inside_are_refused_at_once(http: httpx.Client, url: str) -> None:
    answer = http.post("/v1/unwrap", content=some_glb(), headers=GLB, params={"webhook_url": url})
    assert (answer.status_code, answer.json()["code"]) == (422, "webhook_refused")
    assert answer.json()["errors"][0]["pointer"] == "/webhook_url"
    assert "secret" not in answer.text


def test_an_address_that_turned_inward_is_refused_when_it_is_called(
    http: httpx.Client, worker: HandWorker, receiver: Receiver, stack: Stack
) -> None:
    """What DNS said at submission does not count any more."""
    job_id = submit(http, f"{receiver.url}/")
    with redis.Redis.from_url(stack.redis.url) as raw:
        raw.hset(f"{PREFIX}job:{job_id}", "webhook_url", "https://192.168.0.1/")
    worker.succeed(job_id)
    log = deliveries(http, job_id, 1)
    assert (log[0]["delivered"], log[0]["status"]) == (False, None)
    assert "not a public address" in log[0]["error"]


def test_loopback_is_refused_by_default(stack: Stack, ca_file: Path) -> None:
    gateway = stack.gateway(key_prefix="strict:", webhook_secrets=json.dumps([NEW]))
    with httpx.Client(base_url=gateway.url, timeout=20.0) as http:
        for host in ("127.0.0.1", "localhost", "[::1]", "0.0.0.0", "127.1"):
            parameters = {"webhook_url": f"https://{host}:8443/"}
            answer = http.post("/v1/unwrap", content=some_glb(), headers=GLB, params=parameters)
            assert (answer.status_code, answer.json()["code"]) == (422, "webhook_refused")
    gateway.stop()


def test_secrets_and_addresses_stay_out_of_the_log(
    http: httpx.Client, worker: HandWorker, receiver: Receiver, gateway: Gateway
) -> None:
    job_id = submit(http, f"{receiver.url}/?token=in-the-address")
    worker.succeed(job_id)
    deliveries(http, job_id, 1)
    text = gateway.log.read_text()
    for secret in (NEW, OLD, "in-the-address"):
        assert secret not in text
