"""The options of an unwrap: the one definition that every surface is made from.

Command-line flags, query parameters, the gRPC message and the documentation read the fields below:
name, default, range, unit and meaning are stated here and nowhere else.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from partuv_contract.errors import OptionError


def _option(
    meaning: str, *, unit: str | None = None, alias: str | None = None, **rules: Any
) -> Any:
    """A field with its one-line meaning, its unit and its short name on the command line."""
    known = {"unit": unit, "alias": alias}
    extra: dict[str, Any] = {key: value for key, value in known.items() if value}
    return Field(description=meaning, json_schema_extra=extra, **rules)


class UnwrapOptions(BaseModel):
    """How one asset is to be unwrapped."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    max_area_distortion: float = _option(
        "largest mean area distortion allowed in a chart (1 is none)",
        unit="ratio",
        alias="threshold",
        default=1.25,
        gt=1.0,
        le=10.0,
    )
    min_angular: float = _option(
        "mean angular score that the atlas stays above (1 keeps all angles)",
        unit="score",
        default=0.95,
        ge=0.0,
        lt=1.0,
    )
    profile: Literal["balanced", "conformal"] = _option(
        "balanced: few charts with even texels; conformal: angles kept, as in the PartUV paper",
        default="balanced",
    )
    flattening: Literal["abf", "lscm"] = _option(
        "first solver of a chart: angle-based (better) or least squares (faster)", default="abf"
    )
    denoise: Literal["auto", "off"] | Annotated[float, Field(gt=0.0, le=1.0)] = _option(
        "smooth a copy of noisy surfaces to decide on: auto, off or a strength in (0, 1]",
        default="auto",
    )
    features: Literal["geometric", "partfield", "normals", "auto"] = _option(
        "what the part tree is made from; auto: partfield if this installation has a checkpoint, "
        "else geometric",
        default="geometric",
    )
    parts: Literal["search", "auto"] | Annotated[int, Field(ge=1, le=10_000)] = _option(
        "which parts faces and charts belong to; search: those that the charts were searched in; "
        "auto: as many as people would name; or their number",
        default="search",
    )
    resolution: int = _option(
        "side of the texture that the gutter is measured on",
        unit="texels",
        default=1024,
        ge=16,
        le=65536,
    )
    gutter_texels: float = _option(
        "least distance between two charts",
        unit="texels",
        alias="gutter",
        default=4.0,
        ge=0.0,
        le=256.0,
    )
    existing_uv: Literal["keep", "append", "replace"] = _option(
        "keep: the atlas becomes the first UV set and all others move up, with the textures that "
        "use them; append: it becomes the first free set; replace: it takes the first set's place",
        default="keep",
    )
    scope: Literal["scene", "mesh"] = _option(
        "scene: one atlas for all meshes; mesh: one for each", default="scene"
    )
    only: tuple[str, ...] = _option(
        "names of meshes or materials to unwrap, all others stay as they are; none: everything",
        default=(),
        max_length=1000,
    )
    compress: Literal["none", "meshopt"] = _option(
        "how the geometry of the result is stored", default="none"
    )
    deadline_s: float | None = _option(
        "seconds after which the best atlas found so far is completed; none: take the time needed",
        unit="seconds",
        default=None,
        gt=0.0,
    )

    @classmethod
    def parse(cls, values: dict[str, Any]) -> UnwrapOptions:
        """Validate untrusted values; raises `OptionError` with the name of the first bad option."""
        try:
            return cls.model_validate(values)
        except ValidationError as failure:
            first = failure.errors(include_url=False)[0]
            name = str(first["loc"][0]) if first["loc"] else ""
            raise OptionError(f"option {name}: {first['msg']}", pointer=f"/{name}") from failure
