"""`partuv gateway`: REST and gRPC, for a Redis and workers that run elsewhere."""

from __future__ import annotations

import argparse
import signal
import sys
from collections.abc import Sequence
from types import FrameType
from typing import Any

from partuv_contract.logs import set_up_logs
from pydantic import ValidationError

from partuv_service.main import Gateway
from partuv_service.settings import Settings

_EXIT_USAGE = 2


def command(arguments: Sequence[str]) -> int:
    """Serve REST and gRPC; settings come from PARTUV_* variables."""
    parser = argparse.ArgumentParser("partuv gateway", description=command.__doc__)
    parser.add_argument("--host", help="address to listen on")
    parser.add_argument("--port", type=int, help="port of the REST interface")
    parser.add_argument("--grpc-port", type=int, help="port of the gRPC interface; -1: none")
    given = vars(parser.parse_args(arguments))
    try:
        settings = read_settings(
            {name: value for name, value in given.items() if value is not None}
        )
    except ValidationError as failure:
        print(f"partuv gateway: {explain(failure)}", file=sys.stderr)
        return _EXIT_USAGE
    set_up_logs(settings.log_level)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, _goodbye)
    Gateway(settings).run()
    return 0


def _goodbye(number: int, frame: FrameType | None) -> None:
    """For a signal before uvicorn listens, and for the one it raises again once all is closed."""
    sys.exit(0)


def read_settings(overrides: dict[str, Any]) -> Settings:
    """Settings from the environment, with overrides."""
    return Settings(**overrides)


def explain(failure: ValidationError) -> str:
    """What is wrong with the settings, without their values: some are secret."""
    return "; ".join(
        f"{'.'.join(map(str, error['loc'])) or 'settings'}: {error['msg']}"
        for error in failure.errors(include_input=False, include_context=False)
    )
