"""What the gateway bears: `python -m bench.load [--seconds 20]`.

One gateway process, one worker, one Redis, and the clients beside them, all on this machine:

- how long `/healthz` takes at rest, and while a 60 MB file is uploaded again and again and 50
  clients follow jobs by server-sent events (the probe is a process of its own);
- how many polls of a job and how many submissions a second it answers.
"""

from __future__ import annotations

import argparse
import asyncio
import http.client
import multiprocessing
import os
import statistics
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from multiprocessing.synchronize import Event
from urllib.parse import urlsplit

import httpx
import numpy as np

from tests.support.follow import GLB, running, submit
from tests.support.glb_builder import tetrahedron
from tests.support.meshes import quick, slow
from tests.support.service import Stack, wait_for_workers

UPLOAD_BYTES, LISTENERS, CONNECTIONS = 60_000_000, 50, 16
_PROBE_PAUSE_S = 0.02


def big_glb() -> bytes:
    """A GLB of 60 MB: little to unwrap, much to carry."""
    document = tetrahedron()
    document.accessor(np.zeros(UPLOAD_BYTES // 4, "f"))
    return document.build()


def upload_until(stop: Event, url: str, counted: multiprocessing.Queue[int]) -> None:
    """Upload and delete, one after the other."""
    content, count = big_glb(), 0
    with httpx.Client(base_url=url, timeout=120.0) as http:
        while not stop.is_set():
            answer = http.post("/v1/unwrap", content=content, headers=GLB)
            assert answer.status_code == 202, answer.text
            http.delete(answer.headers["location"])
            count += 1
    counted.put(count)


def listen_until(stop: Event, url: str, job_ids: Sequence[str]) -> None:
    """Follow jobs, each client one."""

    async def follow(http: httpx.AsyncClient, job_id: str) -> None:
        async with http.stream("GET", f"/v1/jobs/{job_id}/events") as answer:
            async for _ in answer.aiter_lines():
                pass

    async def follow_all() -> None:
        limits = httpx.Limits(max_connections=LISTENERS)
        async with httpx.AsyncClient(base_url=url, timeout=None, limits=limits) as http:
            tasks = [
                asyncio.create_task(follow(http, job_ids[n % len(job_ids)]))
                for n in range(LISTENERS)
            ]
            await asyncio.to_thread(stop.wait)
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)

    with suppress(httpx.TransportError):
        asyncio.run(follow_all())


def probe(url: str, seconds: float, found: multiprocessing.Queue[list[float]]) -> None:
    """Milliseconds of `/healthz`, asked again and again on one connection."""
    place = urlsplit(url)
    assert place.hostname is not None
    connection = http.client.HTTPConnection(place.hostname, place.port)
    taken, end = [], time.monotonic() + seconds
    while time.monotonic() < end:
        started = time.perf_counter()
        connection.request("GET", "/healthz")
        connection.getresponse().read()
        taken.append((time.perf_counter() - started) * 1000)
        time.sleep(_PROBE_PAUSE_S)
    found.put(taken)


def probed(url: str, seconds: float) -> list[float]:
    found: multiprocessing.Queue[list[float]] = multiprocessing.Queue()
    process = multiprocessing.Process(target=probe, args=(url, seconds, found))
    process.start()
    taken = found.get()
    process.join()
    return taken


def told(name: str, taken_ms: list[float]) -> None:
    cuts = statistics.quantiles(taken_ms, n=100)
    print(
        f"{name}: p50 {cuts[49]:.1f} ms, p99 {cuts[98]:.1f} ms, worst {max(taken_ms):.1f} ms "
        f"({len(taken_ms)} probes)",
        flush=True,
    )


def healthz_under_load(url: str, seconds: float) -> None:
    """The probe, at rest and under uploads and listeners."""
    told("/healthz at rest", probed(url, seconds))
    stop = multiprocessing.Event()
    counted: multiprocessing.Queue[int] = multiprocessing.Queue()
    with httpx.Client(base_url=url, timeout=60.0) as http:
        job_ids = [submit(http, slow(n), deadline_s=int(seconds)) for n in range(5)]
        running(http, job_ids[0])
        processes = [
            multiprocessing.Process(target=upload_until, args=(stop, url, counted)),
            multiprocessing.Process(target=listen_until, args=(stop, url, job_ids)),
        ]
        for process in processes:
            process.start()
        time.sleep(2.0)
        told(f"/healthz under 60 MB uploads and {LISTENERS} listeners", probed(url, seconds))
        stop.set()
        print(f"  uploads of 60 MB meanwhile: {counted.get()}")
        for process in processes:
            process.join()
        for job_id in job_ids:
            http.delete(f"/v1/jobs/{job_id}")


async def throughput(url: str, seconds: float, request: Callable[[], bytes]) -> tuple[float, float]:
    """Answers per second over some connections, and the 99th percentile in ms."""
    place, end, taken = urlsplit(url), time.monotonic() + seconds, list[float]()

    async def client() -> None:
        reader, writer = await asyncio.open_connection(place.hostname, place.port)
        while time.monotonic() < end:
            started = time.perf_counter()
            writer.write(request())
            head = await reader.readuntil(b"\r\n\r\n")
            assert head.startswith(b"HTTP/1.1 20"), head
            size = head.lower().partition(b"content-length: ")[2].partition(b"\r")[0]
            await reader.readexactly(int(size))
            taken.append((time.perf_counter() - started) * 1000)
        writer.close()

    await asyncio.gather(*(client() for _ in range(CONNECTIONS)))
    return len(taken) / seconds, statistics.quantiles(taken, n=100)[98]


def request(line: str, body: bytes = b"") -> bytes:
    head = f"{line} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(body)}\r\n"
    return f"{head}Content-Type: model/gltf-binary\r\n\r\n".encode() + body


def main() -> int:
    """Measure all of it and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=20.0, help="of each measurement")
    seconds = parser.parse_args().seconds
    load = os.getloadavg()[0]
    print(f"{os.cpu_count()} processors, {load:.1f} other processes running at the start")
    stack = Stack(max_queued_jobs="0", log_level="WARNING")
    try:
        gateway = stack.gateway()
        worker = stack.worker(slots="1", threads_per_job="1")
        wait_for_workers(gateway, 1)
        healthz_under_load(gateway.url, seconds)
        worker.stop()  # what follows measures the gateway, not the engine
        with httpx.Client(base_url=gateway.url) as http:
            job_id = submit(http, quick(2))
        poll, post = request(f"GET /v1/jobs/{job_id}"), request("POST /v1/unwrap", quick(3))
        for name, one in (("polls", poll), ("submissions of 3 kB", post)):
            rate, p99_ms = asyncio.run(throughput(gateway.url, seconds, lambda one=one: one))
            print(f"{name}: {rate:.0f} a second, p99 {p99_ms:.0f} ms, {CONNECTIONS} connections")
    finally:
        stack.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
