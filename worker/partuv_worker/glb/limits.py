"""What a reader is willing to take on, checked before anything is allocated."""

from __future__ import annotations

from pydantic import BaseModel, ConfigDict, Field

_MIB = 1 << 20


class Limits(BaseModel):
    """Upper bounds for one file. Crossing one raises `LimitError`."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    file_bytes: int = Field(default=512 * _MIB, gt=0, description="bytes of the file")
    json_bytes: int = Field(default=64 * _MIB, gt=0, description="bytes of its JSON chunk")
    json_depth: int = Field(default=64, gt=0, description="nested lists and objects of the JSON")
    json_values: int = Field(default=4_000_000, gt=0, description="values of the JSON")
    nodes: int = Field(default=500_000, gt=0, description="nodes")
    node_depth: int = Field(default=1_000, gt=0, description="nested nodes")
    primitives: int = Field(default=100_000, gt=0, description="primitives of all meshes")
    vertices: int = Field(
        default=20_000_000, gt=0, description="vertices of all primitives, shared ones each time"
    )
    faces: int = Field(default=8_000_000, gt=0, description="triangles to unwrap")
    decoded_bytes: int = Field(
        default=2048 * _MIB, gt=0, description="bytes of all accessors, and of all streams, decoded"
    )
    expansion: int = Field(
        default=2000, gt=0, description="decoded bytes per byte of a compressed stream"
    )


DEFAULT_LIMITS = Limits()
