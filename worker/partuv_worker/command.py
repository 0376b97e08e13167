"""`partuv worker`: takes jobs from the queue and runs them."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from celery.signals import setup_logging
from partuv_contract.logs import set_up_logs
from pydantic import ValidationError

from partuv_worker.app import create_app
from partuv_worker.settings import WorkerSettings

_EXIT_USAGE = 2
_STALE_S = 60.0


def command(arguments: Sequence[str]) -> int:
    """Run jobs from the queue; settings come from PARTUV_* variables."""
    parser = argparse.ArgumentParser("partuv worker", description=command.__doc__)
    parser.add_argument("--slots", type=int, help="jobs that run at once")
    parser.add_argument(
        "--check",
        type=Path,
        metavar="FILE",
        help="only tell whether the worker that touches FILE consumes",
    )
    parsed = parser.parse_args(arguments)
    if parsed.check is not None:
        return 0 if _fresh(parsed.check) else 1
    try:
        settings = WorkerSettings(**({} if parsed.slots is None else {"slots": parsed.slots}))
    except ValidationError as failure:
        problems = [f"{e['loc'][0]}: {e['msg']}" for e in failure.errors(include_input=False)]
        print(f"partuv worker: {'; '.join(problems)}", file=sys.stderr)
        return _EXIT_USAGE
    set_up_logs(settings.log_level)
    setup_logging.connect(_keep_our_logs)
    worker = create_app(settings).Worker(
        quiet=True, without_gossip=True, without_mingle=True, without_heartbeat=True
    )
    worker.start()
    return int(worker.exitcode or 0)


def _keep_our_logs(**_: object) -> None:
    """Celery sets up logs of its own unless somebody listens to this signal."""


def _fresh(health_file: Path) -> bool:
    try:
        return time.time() - health_file.stat().st_mtime < _STALE_S
    except OSError:
        return False
