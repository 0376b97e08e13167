"""`partuv keys`: make an API key."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence

from partuv_service.callers import new_key


def command(arguments: Sequence[str]) -> int:
    """Make an API key, and what to configure for it."""
    parser = argparse.ArgumentParser("partuv keys", description=command.__doc__)
    parser.add_argument("name", help="whose key it is; its jobs belong to this name")
    name = parser.parse_args(arguments).name
    key, digest = new_key()
    print(f"the key, shown only now:  {key}")
    print(f"for the service:          PARTUV_API_KEYS='{json.dumps({name: digest})}'")
    return 0
