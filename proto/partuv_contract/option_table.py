"""The options as a table: what `/v1/options`, the OpenAPI parameters and the README show."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, Field

from partuv_contract.options import UnwrapOptions


class OptionInfo(BaseModel):
    """One option: its name, what it may be and what it means."""

    name: str = Field(description="Name in queries, forms and messages")
    meaning: str = Field(description="What it does")
    default: Any = Field(description="Value where none is given")
    unit: str | None = Field(default=None, description="Unit of the value")
    alias: str | None = Field(default=None, description="Short name on the command line")
    value_schema: dict[str, Any] = Field(description="JSON schema of the value")


def option_table() -> list[OptionInfo]:
    """Every option, in the order of its definition."""
    schema = UnwrapOptions.model_json_schema()
    return [_info(name, dict(field)) for name, field in schema["properties"].items()]


def _info(name: str, field: dict[str, Any]) -> OptionInfo:
    field.pop("title", None)
    return OptionInfo(
        name=name,
        meaning=field.pop("description"),
        default=field.pop("default", None),
        unit=field.pop("unit", None),
        alias=field.pop("alias", None),
        value_schema=field,
    )
