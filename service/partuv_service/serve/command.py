"""`partuv serve`: gateway, worker and Redis on this machine, from one command."""

from __future__ import annotations

import argparse
import json
import signal
import socket
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from types import FrameType
from typing import Any

from partuv_contract.errors import ComponentMissingError
from pydantic import ValidationError

from partuv_service.command import explain, read_settings
from partuv_service.serve.data_folder import DataFolder, default_folder
from partuv_service.serve.errand import Errand, run_errand
from partuv_service.serve.processes import Kept
from partuv_service.serve.redis_server import RedisServer
from partuv_service.settings import Settings

_EXIT_USAGE = 2
_EXIT_COMPONENT_MISSING = 5
_LOOK_S = 0.3
_GATEWAY_PATIENCE_S = 10.0
_WORKER_PATIENCE_S = 20.0
_RESULT_ROOM_BYTES = 2**30  # Redis may hold this much more than the uploads' budget


class Stopped(Exception):
    """Ctrl-C or SIGTERM."""


def command(arguments: Sequence[str]) -> int:
    """Run the whole service here: REST, gRPC, a worker and Redis. Ctrl-C stops all."""
    parsed = _parser().parse_args(arguments)
    for name in ("port", "grpc_port"):
        if getattr(parsed, name) == 0:
            setattr(parsed, name, _any_port())
    given = {name: getattr(parsed, name) for name in ("host", "port", "grpc_port")}
    try:
        settings = read_settings({key: value for key, value in given.items() if value is not None})
    except ValidationError as failure:
        print(f"partuv serve: {explain(failure)}", file=sys.stderr)
        return _EXIT_USAGE
    for port in (settings.port, settings.grpc_port):
        if port > 0 and not _free(settings.host, port):
            print(f"partuv serve: port {port} is in use, choose another", file=sys.stderr)
            return 1
    folder = DataFolder(parsed.data.resolve())  # Redis works in a folder of its own
    if not folder.lock():
        print(f"partuv serve: {folder.path} is used by another service", file=sys.stderr)
        return 1
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _stop)
    with tempfile.TemporaryDirectory(prefix="partuv-") as run_folder, folder.open_log() as log:
        service = _Service(settings, folder, Path(run_folder), log, parsed.slots)
        try:
            service.start()
            return _stay(service, settings, parsed)
        except ComponentMissingError as missing:
            print(f"partuv serve: {missing.message}", file=sys.stderr)
            return _EXIT_COMPONENT_MISSING
        except Stopped:
            print("\nstopping")
            return 0
        finally:
            service.stop()


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("partuv serve", description=command.__doc__)
    parser.add_argument("--host", help="address to listen on (default: this machine only)")
    parser.add_argument("--port", type=int, help="port of the REST interface; 0: any")
    parser.add_argument(
        "--grpc-port", type=int, help="port of the gRPC interface; 0: any, -1: none"
    )
    parser.add_argument("--slots", type=int, default=1, help="jobs that run at once")
    parser.add_argument(
        "--data", type=Path, default=default_folder(), help="folder for jobs and log (%(default)s)"
    )
    parser.add_argument("--submit", type=Path, metavar="IN.glb", help="unwrap this file first")
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("unwrapped.glb"), help="result of --submit"
    )
    parser.add_argument("--report", type=Path, help="figures of --submit, as JSON")
    parser.add_argument("--preview", type=Path, help="atlas of --submit as a picture (PNG)")
    parser.add_argument("--stop", action="store_true", help="stop after --submit")
    return parser


class _Service:
    """The processes, in the order in which they need each other."""

    def __init__(
        self, settings: Settings, folder: DataFolder, run_folder: Path, log: Any, slots: int
    ) -> None:
        self._redis: RedisServer | None = None
        self._redis_url = settings.redis_url.get_secret_value()
        if "redis_url" not in settings.model_fields_set:
            self._redis = RedisServer(
                folder.path / "redis",
                run_folder / "redis.sock",
                maxmemory_bytes=settings.store_budget_bytes + _RESULT_ROOM_BYTES,
                keep_open=folder.lock_descriptor,
            )
            self._redis_url = self._redis.url
        secrets = [secret.get_secret_value() for secret in settings.webhook_secrets]
        environment = {
            "PARTUV_REDIS_URL": self._redis_url,
            "PARTUV_HOST": settings.host,
            "PARTUV_PORT": str(settings.port),
            "PARTUV_GRPC_PORT": str(settings.grpc_port),
            "PARTUV_WEBHOOK_SECRETS": json.dumps(secrets or [folder.webhook_secret()]),
        }
        python = [sys.executable, "-m"]
        worker = [*python, "partuv_worker", "--slots", str(slots)]
        self._worker = Kept("worker", worker, environment, log)
        self._gateway = Kept("gateway", [*python, "partuv_service"], environment, log)

    def start(self) -> None:
        if self._redis is not None:
            self._redis.start()
        self._worker.start()
        self._gateway.start()

    def keep(self) -> bool:
        """Look after all; False when one of them can't be kept alive."""
        if self._redis is not None and not self._redis.alive:
            self._redis.start()
        for process in (self._worker, self._gateway):
            if not process.keep():
                print(f"partuv serve: the {process.name} keeps dying", file=sys.stderr)
                return False
        return True

    def stop(self) -> None:
        self._gateway.stop(_GATEWAY_PATIENCE_S)
        self._worker.stop(_WORKER_PATIENCE_S)
        if self._redis is not None:
            self._redis.stop()


def _stay(service: _Service, settings: Settings, parsed: argparse.Namespace) -> int:
    url = f"http://{settings.host}:{settings.port}"
    grpc = f", gRPC on port {settings.grpc_port}" if settings.grpc_port >= 0 else ""
    print(f"PartUV service on {url} (documentation: {url}/docs){grpc}")
    print(f"jobs and log in {parsed.data}; Ctrl-C stops", flush=True)
    if parsed.submit is not None:
        errand = Errand(parsed.submit, parsed.output, parsed.report, parsed.preview)
        code = run_errand(url, errand, service.keep)
        if parsed.stop or code:
            return code
    while service.keep():
        time.sleep(_LOOK_S)
    print(f"see {parsed.data / 'service.log'}", file=sys.stderr)
    return 1


def _any_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _free(host: str, port: int) -> bool:
    try:
        family = socket.AF_INET6 if ":" in host else socket.AF_INET
        socket.create_server((host, port), family=family).close()
    except OSError:
        return False
    return True


def _stop(number: int, frame: FrameType | None) -> None:
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, signal.SIG_IGN)  # once is enough: the rest is on its way
    raise Stopped
