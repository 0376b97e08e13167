"""What an unwrap reports: figures a person or a program judges the atlas by."""

from __future__ import annotations

from typing import Literal

from pydantic import BaseModel, ConfigDict, Field


class ChartFigures(BaseModel):
    """One chart."""

    model_config = ConfigDict(frozen=True)

    faces: int
    part: int = Field(description="the part that it, or most of its area, belongs to")
    tile: int = Field(description="the texture tile it lies in")
    area_share: float = Field(description="its share of the surface, 0 to 1")
    area_distortion: float = Field(description="mean area distortion (1 is none)")
    angular: float = Field(description="mean angular score (1 keeps all angles)")


class PartFigures(BaseModel):
    """One part of the model."""

    model_config = ConfigDict(frozen=True)

    id: int = Field(description="its number, from 0")
    faces: int
    area_share: float = Field(description="its share of the surface, 0 to 1")


class ChartedPartFigures(PartFigures):
    """One part of an unwrapped model."""

    charts: int = Field(description="charts that have faces of it")


class TileFigures(BaseModel):
    """One texture tile."""

    model_config = ConfigDict(frozen=True)

    udim: int | None = Field(description="its number in the UVs of the file; none: has own images")
    charts: int
    packing_efficiency: float = Field(description="area of the charts over that of their square")
    covered_texels: int = Field(description="texels whose centre lies in a chart")
    gutter_texels: float | None = Field(
        description="least distance of two charts; none: no two are near each other"
    )
    seconds: float = Field(description="wall time of its packing")


class FeaturesFigures(BaseModel):
    """Where the part tree came from."""

    model_config = ConfigDict(frozen=True)

    prior: str = Field(description="geometric, partfield or normals")
    version: str = Field(description="of the prior; for partfield, the hash of its weights")
    seconds: float = Field(description="wall time it took, without the clustering")


class UnwrapReport(BaseModel):
    """One finished unwrap."""

    model_config = ConfigDict(frozen=True)

    version: str = Field(description="version of the product that made it")
    mode: Literal["unwrap", "repack"] = Field(description="whether the charts are new")
    input_bytes: int
    output_bytes: int
    primitives: int = Field(description="triangle primitives that were unwrapped")
    faces: int = Field(description="triangles that were unwrapped")
    chart_count: int
    part_count: int
    tile_count: int
    area_distortion_worst: float = Field(description="largest mean area distortion of a chart")
    area_distortion_mean: float = Field(description="mean area distortion over all faces")
    angular_mean: float = Field(description="mean angular score over all faces")
    seam_length: float = Field(
        description="length of all seams on the surface over the square root of its area"
    )
    packing_efficiency: float = Field(description="area of the charts over that of their square")
    noise: float | None = Field(
        description="estimated roughness of the surface, 0 is smooth; none: nothing depends on it"
    )
    features: FeaturesFigures | None = Field(description="none: no part tree was needed")
    notes: list[str] = Field(description="what a person should know about this run")
    seconds: dict[str, float] = Field(description="wall time per stage")
    charts: list[ChartFigures]
    parts: list[ChartedPartFigures]
    tiles: list[TileFigures]


class SegmentReport(BaseModel):
    """The parts of a model that was not unwrapped."""

    model_config = ConfigDict(frozen=True)

    version: str = Field(description="version of the product that made it")
    faces: int
    part_count: int
    features: FeaturesFigures
    notes: list[str] = Field(description="what a person should know about this run")
    seconds: float = Field(description="wall time of all")
    parts: list[PartFigures]
