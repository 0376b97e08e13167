"""Prometheus metrics: what this gateway counts, and what all processes counted in Redis."""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import version

from partuv_store.metrics import CHARTS, FACES, RATIOS, SECONDS, buckets
from partuv_store.upkeep import Survey
from prometheus_client import CollectorRegistry, Counter, Histogram
from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    Metric,
)
from prometheus_client.exposition import generate_latest
from prometheus_client.registry import Collector

_HTTP_SECONDS = (0.001, 0.0025, 0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1, 2.5, 5, 10, 60)
_HISTOGRAMS = (
    ("uv_queue_wait_seconds", "wait_seconds", SECONDS, "time between submission and start"),
    ("uv_job_total_seconds", "total_seconds", SECONDS, "time between submission and end"),
    ("uv_mesh_faces", "faces", FACES, "triangles per job"),
    ("uv_charts", "charts", CHARTS, "charts per job"),
    ("uv_atlas_utilisation_ratio", "utilisation", RATIOS, "covered share of the atlas"),
)


class Metrics:
    """The metrics of one gateway."""

    def __init__(self) -> None:
        self._registry = CollectorRegistry()
        self.requests = Counter(
            "uv_http_requests",
            "requests answered",
            ("route", "method", "status"),
            registry=self._registry,
        )
        self.durations = Histogram(
            "uv_http_request_duration_seconds",
            "time to the end of the answer",
            ("route", "method"),
            buckets=_HTTP_SECONDS,
            registry=self._registry,
        )
        self.rpcs = Counter(
            "uv_grpc_requests", "calls answered", ("method", "code"), registry=self._registry
        )

    def render(self, survey: Survey | None) -> bytes:
        """The text that Prometheus reads; without a survey, only what this process knows."""
        registry = CollectorRegistry()
        registry.register(_SurveyCollector(survey))
        return bytes(generate_latest(self._registry)) + bytes(generate_latest(registry))


class _SurveyCollector(Collector):
    def __init__(self, survey: Survey | None) -> None:
        self._survey = survey

    def collect(self) -> Iterator[Metric]:
        build = GaugeMetricFamily("uv_build_info", "what is running", labels=["version"])
        build.add_metric([version("partuv-service")], 1)
        yield build
        yield GaugeMetricFamily(
            "uv_store_up", "1 if Redis answers", value=float(bool(self._survey))
        )
        if self._survey is not None:
            yield from _gauges(self._survey)
            yield from _counters(self._survey.metrics)
            yield from _histograms(self._survey.metrics)


def _gauges(survey: Survey) -> Iterator[Metric]:
    states = GaugeMetricFamily("uv_jobs_in_state", "unfinished jobs", labels=["state"])
    states.add_metric(["queued"], survey.waiting)
    states.add_metric(["running"], survey.running)
    yield states
    depth = GaugeMetricFamily("uv_queue_depth", "jobs that wait", labels=["queue"])
    depth.add_metric(["unwrap"], survey.waiting)
    yield depth
    yield GaugeMetricFamily("uv_store_bytes", "uploads and results", value=survey.stored_bytes)
    yield GaugeMetricFamily("uv_webhooks_waiting", "to be sent", value=survey.webhooks_waiting)
    up = GaugeMetricFamily("uv_worker_up", "workers that are alive", labels=["worker"])
    slots = GaugeMetricFamily("uv_worker_slots", "jobs a worker runs at once", labels=["worker"])
    busy = GaugeMetricFamily("uv_worker_busy_slots", "jobs a worker runs now", labels=["worker"])
    beat = GaugeMetricFamily(
        "uv_worker_last_heartbeat_timestamp_seconds", "its last word", labels=["worker"]
    )
    for worker in survey.workers:
        name = [str(worker.get("name", ""))]
        up.add_metric(name, 1)
        slots.add_metric(name, float(worker.get("slots", 0)))
        busy.add_metric(name, float(worker.get("busy", 0)))
        beat.add_metric(name, float(worker.get("at", 0)))
    yield from (up, slots, busy, beat)


def _counters(metrics: dict[str, float]) -> Iterator[Metric]:
    created = CounterMetricFamily("uv_jobs_created", "jobs accepted", labels=["queue"])
    created.add_metric(["unwrap"], metrics.get("created", 0.0))
    yield created
    yield CounterMetricFamily(
        "uv_cache_hits", "jobs answered from the cache", value=metrics.get("cache_hits", 0.0)
    )
    yield CounterMetricFamily(
        "uv_upload_bytes", "bytes that became jobs", value=metrics.get("upload_bytes", 0.0)
    )
    finished = CounterMetricFamily("uv_jobs_finished", "jobs ended", labels=["outcome", "code"])
    webhooks = CounterMetricFamily("uv_webhook_deliveries", "tries", labels=["outcome"])
    for name, value in sorted(metrics.items()):
        kind, _, labels = name.partition(":")
        if kind == "finished":
            finished.add_metric(labels.split(":", 1), value)
        elif kind == "webhooks":
            webhooks.add_metric([labels], value)
    yield from (finished, webhooks)


def _histograms(metrics: dict[str, float]) -> Iterator[Metric]:
    for name, field, bounds, meaning in _HISTOGRAMS:
        cumulative, total = buckets(metrics, field, bounds)
        yield HistogramMetricFamily(name, meaning, buckets=cumulative, sum_value=total)
    stages = HistogramMetricFamily("uv_job_duration_seconds", "time in a stage", labels=["stage"])
    names = {field.split(":")[1] for field in metrics if field.startswith("stage_seconds:")}
    for stage in sorted(names):
        cumulative, total = buckets(metrics, f"stage_seconds:{stage}", SECONDS)
        stages.add_metric([stage], cumulative, total)
    yield stages
