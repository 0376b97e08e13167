"""Probes, options, version, metrics, and addresses that aren't there."""

import re

import httpx
import pytest
import redis
from partuv_contract.option_table import option_table
from partuv_contract.options import UnwrapOptions
from partuv_store import execution
from prometheus_client.parser import text_string_to_metric_families

from tests.support.hand_worker import HandWorker
from tests.support.service import Stack, until
from tests.support.uploads import submit


def test_alive_and_ready(http: httpx.Client, worker: HandWorker) -> None:
    assert http.get("/healthz").json() == {"status": "ok"}
    worker.store.run(execution.announce("w-ready", {"build": "b-ready"}, ""))
    ready = http.get("/readyz").json()
    assert ready["status"] == "ok"
    assert ready["workers"] >= 1
    assert "b-ready" in http.get("/version").json()["workers"]
    worker.store.run(execution.withdraw("w-ready"))


def test_options_are_the_validated_ones(http: httpx.Client) -> None:
    told = {info["name"]: info for info in http.get("/v1/options").json()}
    assert told.keys() == UnwrapOptions.model_fields.keys()
    assert told["resolution"]["default"] == UnwrapOptions().resolution
    assert told["resolution"]["value_schema"]["minimum"] == 16
    assert all(info["meaning"] for info in told.values())
    assert [info.name for info in option_table()] == list(told)


def test_metrics_count_what_happens(http: httpx.Client, worker: HandWorker) -> None:
    def read() -> dict[tuple[str, tuple], float]:
        families = text_string_to_metric_families(http.get("/metrics").text)
        return {
            (sample.name, tuple(sorted(sample.labels.items()))): sample.value
            for family in families
            for sample in family.samples
        }

    before = read()
    worker.store.run(execution.announce("w-metric", {"name": "w-metric", "slots": 2}, ""))
    worker.succeed(submit(http))
    worker.fail(submit(http))
    after = read()

    def grown(name: str, **labels: str) -> float:
        key = (name, tuple(sorted(labels.items())))
        return after[key] - before.get(key, 0.0)

    assert grown("uv_jobs_created_total", queue="unwrap") == 2
    assert grown("uv_jobs_finished_total", outcome="succeeded", code="") == 1
    assert grown("uv_jobs_finished_total", outcome="failed", code="malformed_glb") == 1
    assert grown("uv_queue_wait_seconds_count") == 2
    assert grown("uv_job_total_seconds_bucket", le="+Inf") == 2
    route = {"route": "/v1/unwrap", "method": "POST"}
    assert grown("uv_http_requests_total", **route, status="202") == 2
    assert grown("uv_http_request_duration_seconds_count", **route) == 2
    assert after["uv_worker_slots", (("worker", "w-metric"),)] == 2
    assert after["uv_store_up", ()] == 1
    assert not [labels for _, labels in after if re.search("job_[0-9a-f]{8}", str(labels))]
    worker.store.run(execution.withdraw("w-metric"))


@pytest.mark.parametrize(
    ("method", "path", "status", "code"),
    [
        ("GET", "/nowhere", 404, "not_found"),
        ("GET", "/v1/unwrap", 405, "method_not_allowed"),
        ("PUT", "/v1/options", 405, "method_not_allowed"),
        ("GET", "/v1/jobs", 404, "not_found"),
    ],
)
def test_wrong_addresses_are_problems_too(
    http: httpx.Client, method: str, path: str, status: int, code: str
) -> None:
    answer = http.request(method, path)
    assert answer.headers["content-type"] == "application/problem+json"
    assert (answer.status_code, answer.json()["code"]) == (status, code)
    assert status != 405 or answer.headers["allow"]


def test_the_root_leads_to_the_documentation(http: httpx.Client) -> None:
    answer = http.get("/", follow_redirects=True)
    assert answer.status_code == 200
    assert "openapi.json" in answer.text


@pytest.mark.parametrize("taken", [False, True])
def test_a_lost_message_is_sent_again(http: httpx.Client, stack: Stack, taken: bool) -> None:
    """The broker forgets, or a worker dies that had taken it; the job record does not."""
    job_id = submit(http)
    with redis.Redis.from_url(stack.redis.url) as raw:
        (message,) = [m for m in raw.lrange("partuv:mq:unwrap", 0, -1) if job_id.encode() in m]
        raw.lrem("partuv:mq:unwrap", 0, message)
        if taken:
            raw.hset("partuv:mq:unacked", "some-delivery", message)
        raw.hset(f"partuv:job:{job_id}", "published_at", "1")
        until(lambda: any(job_id.encode() in m for m in raw.lrange("partuv:mq:unwrap", 0, -1)))
        raw.hdel("partuv:mq:unacked", "some-delivery")


@pytest.mark.parametrize("_", range(6))
def test_it_stops_in_the_midst_of_upkeep(stack: Stack, _: int) -> None:
    """On Python 3.11 a library may swallow a cancellation (python/cpython#86296)."""
    busy = stack.gateway(upkeep_interval_s="0.000001", key_prefix="stopping:")
    assert busy.stop() == 0
