"""The life of a job in the store: every transition, against a real Redis."""

import hashlib
import json
import time
from dataclasses import replace

import pytest
import redis
from partuv_contract.jobs import JobStatus
from partuv_contract.service_errors import StoreFullError, StoreUnavailableError
from partuv_store import JobRecord, Store, blobs, execution, submission, upkeep

GLB = b"glTF" + bytes(1000)
REPORT = json.dumps({"charts": 3})
BASE = submission.Submission(
    id="job_a",
    owner="anna",
    options="{}",
    input_sha256=hashlib.sha256(GLB).hexdigest(),
    input_bytes=len(GLB),
    input_chunks=2,
    fingerprint="f1",
    cache_key="c1",
    retention_ms=60_000,
)
NO_LIMITS = submission.Limits()


def upload(store: Store, job_id: str) -> None:
    store.run(blobs.append(blobs.upload_name(job_id), 0, GLB[:500]))
    store.run(blobs.append(blobs.upload_name(job_id), 1, GLB[500:]))


def submit(store: Store, job_id: str = "job_a", limits=NO_LIMITS, **changes):
    upload(store, job_id)
    return store.run(submission.submit(replace(BASE, id=job_id, **changes), limits))


def look(store: Store, job_id: str = "job_a") -> JobRecord:
    record = store.run(submission.view(job_id))
    assert record is not None
    return record


def claim(store: Store, job_id: str = "job_a", worker: str = "w1", lease_s: float = 30.0):
    record = store.run(execution.claim(job_id, worker, lease_s))
    assert record is not None
    return record


def success(build: str = "b1") -> execution.Ending:
    fields = {
        "report": REPORT,
        "faces": "12",
        "glb_bytes": str(len(GLB)),
        "glb_sha256": BASE.input_sha256,
    }
    return execution.Ending(JobStatus.SUCCEEDED, fields=fields, build=build)


def succeed(store: Store, job_id: str = "job_a") -> bool:
    attempt = claim(store, job_id).attempt
    store.run(blobs.append(blobs.part_name(job_id, attempt, "glb"), 0, GLB))
    return store.run(execution.finish(job_id, attempt, success()))


def leftovers(raw: redis.Redis) -> set[bytes]:
    return {key for key in raw.keys("*") if key != b"partuv:metrics"}


def sweep(store: Store, *, lease_s: float = -1.0):
    return store.run(
        upkeep.sweep(max_losses=2, lost_error='"lost"', queue_error='"late"', lease_s=lease_s)
    )


def test_a_job_waits_runs_and_succeeds(store: Store) -> None:
    assert submit(store) == ("created", "job_a")
    assert submit(store, "job_b", fingerprint="f2", cache_key="c2") == ("created", "job_b")
    assert (look(store).status, look(store).place) == (JobStatus.QUEUED, 0)
    assert look(store, "job_b").place == 1
    record = claim(store)
    assert (record.status, record.attempt, record.place) == (JobStatus.RUNNING, 1, None)
    assert store.read_chunk(blobs.upload_name("job_a"), 1) == GLB[500:]
    assert look(store, "job_b").place == 0
    assert store.run(execution.beat("job_a", 1, 30.0, "search", 0.5)) == "go"
    assert (look(store).stage, look(store).progress) == ("search", 0.5)
    store.run(blobs.append(blobs.part_name("job_a", 1, "glb"), 0, GLB))
    assert store.run(execution.finish("job_a", 1, success()))
    done = look(store)
    assert (done.status, done.progress, done.faces) == (JobStatus.SUCCEEDED, 1.0, 12)
    assert done.document("report") == {"charts": 3}
    assert store.read_chunk(blobs.result_blob(done.result, "glb"), 0) == GLB
    assert store.read_chunk(blobs.upload_name("job_a"), 0) is None


def test_progress_never_falls_and_each_change_is_numbered(store: Store) -> None:
    submit(store)
    claim(store)
    before = look(store).revision
    store.run(execution.beat("job_a", 1, 30.0, "search", 0.5))
    store.run(execution.beat("job_a", 1, 30.0, "search", 0.5))
    assert look(store).revision == before + 1
    store.run(execution.beat("job_a", 1, 30.0, "pack", 0.3))
    assert (look(store).stage, look(store).progress) == ("pack", 0.5)


def test_only_one_worker_gets_a_job(store: Store) -> None:
    submit(store)
    claim(store)
    assert store.run(execution.claim("job_a", "w2", 30.0)) is None
    assert store.run(execution.claim("job_unknown", "w2", 30.0)) is None
    assert claim(store).attempt == 1, (
        "the same worker asking twice (a retried command) has it still"
    )


def test_a_worker_that_was_given_up_can_change_nothing(store: Store) -> None:
    submit(store)
    claim(store)
    assert store.run(execution.give_back("job_a", 1, max_losses=2)) is JobStatus.QUEUED
    assert store.run(execution.beat("job_a", 1, 30.0, "", 0.0)) == "lost"
    second = claim(store, worker="w2")
    assert second.attempt == 2
    store.run(blobs.append(blobs.part_name("job_a", 1, "glb"), 0, b"late"))
    assert not store.run(execution.finish("job_a", 1, success()))
    assert look(store).status is JobStatus.RUNNING
    store.run(blobs.append(blobs.part_name("job_a", 2, "glb"), 0, GLB))
    assert store.run(execution.finish("job_a", 2, success()))
    assert store.run(execution.finish("job_a", 2, success())), "a retried command is no conflict"
    assert store.read_chunk(blobs.result_blob(look(store).result, "glb"), 0) == GLB


def test_the_second_lost_worker_fails_the_job(store: Store) -> None:
    submit(store)
    claim(store, lease_s=0.0)
    time.sleep(0.01)
    assert sweep(store)[0] == 1
    assert look(store).status is JobStatus.QUEUED
    claim(store, lease_s=0.0)
    time.sleep(0.01)
    sweep(store)
    record = look(store)
    assert (record.status, record.document("error")) == (JobStatus.FAILED, "lost")


def test_no_lease_is_reaped_right_after_redis_started(store: Store) -> None:
    submit(store)
    claim(store, lease_s=0.0)
    time.sleep(0.01)
    assert sweep(store, lease_s=10_000.0)[0] == 0
    assert look(store).status is JobStatus.RUNNING


def test_giving_back_without_a_loss_may_happen_often(store: Store) -> None:
    submit(store)
    for attempt in range(1, 6):
        assert claim(store).attempt == attempt
        assert store.run(execution.give_back("job_a", attempt)) is JobStatus.QUEUED


def test_a_given_back_job_keeps_its_place_and_wants_a_message(store: Store) -> None:
    submit(store)
    time.sleep(0.002)
    submit(store, "job_b", fingerprint="f2")
    store.run(submission.published("job_a"))
    store.run(submission.published("job_b"))
    assert store.run(upkeep.unpublished(60.0)) == ([], [])
    claim(store)
    store.run(execution.give_back("job_a", 1))
    assert look(store).place == 0
    time.sleep(0.002)
    assert store.run(upkeep.unpublished(0.0)) == (["job_a"], ["job_b"])


def test_canceling_a_waiting_job_ends_it_at_once(store: Store) -> None:
    submit(store)
    assert store.run(submission.cancel("job_a")) is JobStatus.CANCELED
    assert look(store).time("started_at") is None
    assert store.run(execution.claim("job_a", "w1", 30.0)) is None
    assert store.run(submission.cancel("job_a")) is JobStatus.CANCELED
    assert store.run(submission.cancel("job_unknown")) is None


def test_canceling_a_running_job_reaches_its_worker(store: Store) -> None:
    submit(store)
    claim(store)
    assert store.run(submission.cancel("job_a")) is JobStatus.RUNNING
    assert store.run(execution.beat("job_a", 1, 30.0, "", 0.0)) == "cancel"
    store.run(blobs.append(blobs.part_name("job_a", 1, "glb"), 0, GLB))
    assert store.run(execution.finish("job_a", 1, success()))
    assert look(store).status is JobStatus.CANCELED, "a cancel wins over a result not yet published"


def test_forgetting_leaves_nothing(store: Store, raw: redis.Redis) -> None:
    submit(store, idempotency="i1", webhook_url="https://example.org/")
    assert succeed(store)
    assert store.run(submission.forget("job_a"))
    assert not store.run(submission.forget("job_a"))
    assert leftovers(raw) == set()


@pytest.mark.parametrize("moment", ["waiting", "running", "writing"])
def test_forgetting_an_unfinished_job_leaves_nothing(
    store: Store, raw: redis.Redis, moment: str
) -> None:
    submit(store)
    if moment != "waiting":
        claim(store)
    if moment == "writing":
        store.run(blobs.append(blobs.part_name("job_a", 1, "glb"), 0, GLB))
    store.run(submission.forget("job_a"))
    if moment == "writing":
        store.run(blobs.append(blobs.part_name("job_a", 1, "glb"), 1, GLB))
        assert not store.run(execution.finish("job_a", 1, success()))
    assert leftovers(raw) == set()


def test_an_expired_job_is_swept_with_all_it_had(store: Store, raw: redis.Redis) -> None:
    submit(store, retention_ms=1)
    succeed(store)
    time.sleep(0.01)
    assert sweep(store) == (0, 1)
    assert leftovers(raw) == set()


def test_every_key_of_a_finished_job_dies_even_if_nobody_sweeps(
    store: Store, raw: redis.Redis
) -> None:
    submit(store, idempotency="i1")
    succeed(store)
    lines = {b"partuv:expiry", b"partuv:ledger", b"partuv:bytes"}
    assert {key for key in leftovers(raw) if raw.ttl(key) == -1} == lines


def test_a_job_nobody_takes_fails_when_it_expires(store: Store) -> None:
    submit(store, retention_ms=1)
    time.sleep(0.01)
    sweep(store)
    record = look(store)
    assert (record.status, record.document("error")) == (JobStatus.FAILED, "late")


def test_the_same_work_is_answered_from_the_cache(store: Store, raw: redis.Redis) -> None:
    store.run(execution.announce("w1", {}, "b1"))
    submit(store)
    succeed(store)
    assert submit(store, "job_b") == ("cached", "job_b")
    twin = look(store, "job_b")
    assert (twin.status, twin.cached, twin.faces) == (JobStatus.SUCCEEDED, True, 12)
    assert twin.result == look(store).result
    store.run(submission.forget("job_a"))
    assert store.read_chunk(blobs.result_blob(twin.result, "glb"), 0) == GLB
    store.run(submission.forget("job_b"))
    assert submit(store, "job_c") == ("created", "job_c"), "the cache forgets with its last job"


def test_another_build_or_owner_does_not_share_results(store: Store) -> None:
    store.run(execution.announce("w1", {}, "b1"))
    submit(store)
    succeed(store)
    assert submit(store, "job_b", cache_key="c2")[0] == "created"
    store.run(execution.announce("w1", {}, "b2"))
    assert submit(store, "job_c")[0] == "created"


def test_two_that_made_the_same_result_share_it(store: Store) -> None:
    submit(store)
    submit(store, "job_b")
    assert succeed(store)
    assert succeed(store, "job_b")
    assert look(store).result == look(store, "job_b").result
    assert store.run(upkeep.survey()).stored_bytes == len(GLB)


def test_an_idempotency_key_gives_the_first_job_again(store: Store) -> None:
    assert submit(store, idempotency="i1") == ("created", "job_a")
    assert submit(store, "job_b", idempotency="i1") == ("replayed", "job_a")
    assert submit(store, "job_c", idempotency="i1", fingerprint="other") == (
        "idempotency_key_reused",
        "job_a",
    )
    assert store.run(upkeep.survey()).stored_bytes == len(GLB), "repeated uploads are dropped"
    store.run(submission.forget("job_a"))
    assert submit(store, "job_d", idempotency="i1") == ("created", "job_d")


def test_limits_refuse_and_drop_the_upload(store: Store, raw: redis.Redis) -> None:
    submit(store)
    limits = submission.Limits(queue_limit=1)
    assert store.run(submission.admit("anna", 1, limits)) == "queue_full"
    assert submit(store, "job_b", limits)[0] == "queue_full"
    limits = submission.Limits(owner_limit=1)
    assert store.run(submission.admit("anna", 1, limits)) == "too_many_jobs"
    assert submit(store, "job_b", limits)[0] == "too_many_jobs"
    assert submit(store, "job_b", limits, owner="bert")[0] == "created"
    assert store.run(submission.admit("anna", 1, submission.Limits(budget_bytes=2000))) == (
        "store_full"
    )
    assert raw.exists("partuv:blob:upload:job_b") == 1
    assert raw.exists("partuv:blob:upload:job_c") == 0


def test_the_budget_counts_what_is_stored(store: Store) -> None:
    name = blobs.upload_name("job_a")
    store.run(blobs.append(name, 0, bytes(600), budget_bytes=1000))
    store.run(blobs.append(name, 0, bytes(600), budget_bytes=2000))
    assert store.run(upkeep.survey()).stored_bytes == 600, "a chunk written twice weighs once"
    with pytest.raises(StoreFullError):
        store.run(blobs.append(name, 1, bytes(600), budget_bytes=1000))
    store.run(blobs.drop(name))
    assert store.run(upkeep.survey()).stored_bytes == 0


def test_an_abandoned_upload_leaves_the_ledger(store: Store, raw: redis.Redis) -> None:
    upload(store, "job_a")
    assert 0 < raw.ttl("partuv:blob:upload:job_a") <= 900
    raw.delete("partuv:blob:upload:job_a")
    assert store.run(upkeep.reconcile()) == 1
    assert leftovers(raw) == set()


def test_an_upload_that_got_lost_makes_no_job(store: Store, raw: redis.Redis) -> None:
    assert store.run(submission.submit(BASE, NO_LIMITS)) == ("upload_lost", "")
    assert leftovers(raw) == set()


def test_a_webhook_is_due_once_and_again_after_a_failure(store: Store) -> None:
    submit(store, webhook_url="https://example.org/hook")
    assert store.run(upkeep.due_webhooks(lease_s=60.0, at_most=5)) == []
    succeed(store)
    assert store.run(upkeep.due_webhooks(lease_s=60.0, at_most=5)) == ["job_a"]
    assert store.run(upkeep.due_webhooks(lease_s=60.0, at_most=5)) == []
    store.run(upkeep.webhook_tried("job_a", {"n": 1}, retry_in_s=0.0, outcome="failed"))
    assert store.run(upkeep.due_webhooks(lease_s=60.0, at_most=5)) == ["job_a"]
    store.run(upkeep.webhook_tried("job_a", {"n": 2}, retry_in_s=None, outcome="delivered"))
    assert store.run(upkeep.due_webhooks(lease_s=60.0, at_most=5)) == []
    assert look(store).document("deliveries") == [{"n": 1}, {"n": 2}]


def test_the_rate_is_held_per_owner(store: Store) -> None:
    answers = [store.run(submission.rate("anna", 60, 5)) for _ in range(7)]
    assert answers[:5] == [0] * 5
    assert all(0 < wait_ms <= 1000 for wait_ms in answers[5:])
    assert store.run(submission.rate("bert", 60, 5)) == 0


def test_the_survey_sees_jobs_and_workers(store: Store) -> None:
    store.run(execution.announce("w1", {"slots": 2}, "b1"))
    submit(store)
    submit(store, "job_b")
    claim(store)
    survey = store.run(upkeep.survey())
    assert (survey.waiting, survey.running) == (1, 1)
    assert survey.workers == [{"slots": 2}]
    assert survey.metrics["created"] == 2
    assert survey.metrics["wait_seconds:count"] == 1
    store.run(execution.withdraw("w1"))
    assert store.run(upkeep.survey()).workers == []


def test_an_absent_redis_is_a_named_error() -> None:
    store = Store("unix:///nonexistent/redis.sock", retries=0)
    with pytest.raises(StoreUnavailableError):
        store.run(upkeep.survey())
