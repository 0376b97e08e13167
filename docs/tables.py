"""Writes the tables of docs/service.md from the definitions that the service itself runs on.

`python docs/tables.py` writes them; with --check it only tells whether they are current.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from partuv_contract.option_table import option_table
from partuv_contract.problem import error_kinds, title_of
from partuv_service.settings import Settings
from partuv_worker.settings import WorkerSettings
from pydantic import SecretStr
from pydantic_settings import BaseSettings

PAGE = Path(__file__).with_name("service.md")


def options() -> str:
    """What a caller may ask for."""
    rows = (
        (f"`{info.name}`", _values(info.value_schema), _plain(info.default), info.meaning)
        for info in option_table()
    )
    return _table(("option", "values", "default", "meaning"), rows)


def codes() -> str:
    """Why something did not work."""
    rows = (
        (f"`{code}`", str(kind.http_status), kind.grpc_status, title_of(kind))
        for code, kind in error_kinds().items()
    )
    return _table(("code", "HTTP", "gRPC", "meaning"), rows)


def gateway() -> str:
    """How a gateway is set up."""
    return _settings(Settings)


def worker() -> str:
    """How a worker is set up."""
    return _settings(WorkerSettings)


def _settings(kind: type[BaseSettings]) -> str:
    rows = (
        (f"`PARTUV_{name.upper()}`", _plain(_default(field)), field.description or "")
        for name, field in kind.model_fields.items()
        if name != "limits"
    )
    return _table(("variable", "default", "meaning"), rows)


def _default(field: Any) -> Any:
    value = field.get_default(call_default_factory=True)
    return value.get_secret_value() if isinstance(value, SecretStr) else value


def _plain(value: Any) -> str:
    if value in (None, [], {}, ""):
        return "none"
    return f"`{value}`" if isinstance(value, str) else json.dumps(value)


def _values(schema: dict[str, Any]) -> str:
    if "anyOf" in schema:
        return " or ".join(_values(one) for one in schema["anyOf"] if one.get("type") != "null")
    if "enum" in schema:
        return ", ".join(f"`{word}`" for word in schema["enum"])
    if "const" in schema:
        return f"`{schema['const']}`"
    bounds = [
        f"{sign} {schema[key]:g}"
        for key, sign in (
            ("minimum", "≥"),
            ("exclusiveMinimum", ">"),
            ("maximum", "≤"),
            ("exclusiveMaximum", "<"),
        )
        if key in schema
    ]
    return ", ".join(bounds) or str(schema.get("type", "any"))


def _table(head: tuple[str, ...], rows: Iterable[tuple[str, ...]]) -> str:
    lines = [head, tuple("---" for _ in head), *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines)


TABLES: dict[str, Callable[[], str]] = {
    "options": options,
    "codes": codes,
    "gateway": gateway,
    "worker": worker,
}


def current(page: str) -> str:
    """The page with its tables as they should be."""
    for name, table in TABLES.items():
        first, last = f"<!-- table: {name} -->\n", "\n<!-- end -->"
        found = re.search(f"{first}.*?{last}", page, re.DOTALL)
        assert found is not None, f"{PAGE.name} has no place for the table of {name}"
        page = page[: found.start()] + first + table() + last + page[found.end() :]
    return page


def main() -> int:
    """Write, or check."""
    page = PAGE.read_text()
    wanted = current(page)
    if "--check" in sys.argv[1:]:
        if wanted != page:
            print("docs/service.md is stale; run python docs/tables.py")
        return int(wanted != page)
    PAGE.write_text(wanted)
    return 0


if __name__ == "__main__":
    sys.exit(main())
