"""One job through the service that was just started: the way a client would do it."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import httpx
from partuv_client import ClientError, PartUV
from partuv_contract.jobs import Job

_BAR = 30


class Errand(NamedTuple):
    """What to submit, and which files to write."""

    source: Path
    target: Path
    report: Path | None = None
    preview: Path | None = None


def run_errand(url: str, errand: Errand, keep_alive: Callable[[], bool]) -> int:
    """Submit a file, follow its progress, write the result; the exit code."""
    if not _wait_for_worker(url, keep_alive):
        return 1
    print(f"POST {url}/v1/unwrap  <- {errand.source}")
    started = time.monotonic()
    try:
        with PartUV(url) as client:
            unwrapped = client.unwrap(errand.source, on_progress=_show)
            seconds = time.monotonic() - started
            if errand.preview is not None:
                errand.preview.write_bytes(client.fetch(unwrapped.job, "preview"))
    except ClientError as failure:
        print(f"\npartuv serve: {failure}", file=sys.stderr)
        return 1
    unwrapped.save(errand.target)
    report = unwrapped.job.report or {}
    if errand.report is not None:
        errand.report.write_text(json.dumps(report, indent=2) + "\n")
    print(
        f"\nGET {url}{unwrapped.job.links.result}  -> {errand.target}\n"
        f"{report.get('faces')} faces in {report.get('chart_count')} charts, {seconds:.1f} s"
    )
    return 0


def _wait_for_worker(url: str, keep_alive: Callable[[], bool]) -> bool:
    while keep_alive():
        try:
            answer = httpx.get(f"{url}/readyz", timeout=5.0)
            if answer.status_code == 200 and answer.json()["workers"]:
                return True
        except httpx.TransportError:
            pass  # not listening yet
        time.sleep(0.2)
    return False


def _show(job: Job) -> None:
    filled = round(job.progress * _BAR)
    bar = "#" * filled + "." * (_BAR - filled)
    line = f"[{bar}] {job.progress:4.0%}  {job.status.value:<9}  {job.stage or '':<16}"
    print(f"\r{line}" if sys.stdout.isatty() else line, end="" if sys.stdout.isatty() else "\n")
    sys.stdout.flush()
