"""The options of an unwrap: the one definition that every surface is made from.

Command-line flags, query parameters, the gRPC message and the documentation read the fields below:
name, default, range, unit and meaning are stated here and nowhere else.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from partuv_contract.errors import OptionError
from partuv_contract.texel_weights import TexelWeights, read_texel_weights


def _option(
    meaning: str, *, unit: str | None = None, alias: str | None = None, **rules: Any
) -> Any:
    """A field with its one-line meaning, its unit and its short name on the command line."""
    known = {"unit": unit, "alias": alias}
    extra: dict[str, Any] = {key: value for key, value in known.items() if value}
    return Field(description=meaning, json_schema_extra=extra, **rules)


_ONLY_IN_UNWRAP = (
    "max_area_distortion",
    "min_angular",
    "profile",
    "flattening",
    "quality",
    "denoise",
    "cut_below_efficiency",
)
_ONLY_IN_REPACK = ("repack_scale",)


class _ClashError(ValueError):
    """An option that does not go with another one."""

    def __init__(self, option: str, message: str) -> None:
        super().__init__(message)
        self.option = option


class UnwrapOptions(BaseModel):
    """How one asset is to be unwrapped."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    mode: Literal["unwrap", "repack"] = _option(
        "unwrap: make new charts; repack: keep the charts of the first UV set and pack them anew",
        default="unwrap",
    )
    repack_scale: Literal["uniform", "keep"] = _option(
        "size of the charts that repack keeps; uniform: as many texels per surface everywhere; "
        "keep: charts stay as large to each other as they are",
        default="uniform",
    )
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
    quality: Literal["fast", "standard", "best"] = _option(
        "work to spend; fast: about half of the time, some charts more; best: several "
        "searches, of which each component gets the one with the fewest charts, never more charts "
        "in all than standard, and a longer packing",
        default="standard",
    )
    denoise: Literal["auto", "off"] | Annotated[float, Field(gt=0.0, le=1.0)] = _option(
        "smooth a copy of noisy surfaces to decide on: auto, off or a strength in (0, 1]",
        default="auto",
    )
    cut_below_efficiency: float = _option(
        "cut a chart in two that is so long that it alone would keep the atlas' packing efficiency "
        "below this, where that helps; 0: never",
        unit="share",
        default=0.47,
        ge=0.0,
        lt=1.0,
    )
    features: Literal["geometric", "partfield", "normals", "auto"] = _option(
        "what the part tree is made from; auto: partfield if this installation has a checkpoint, "
        "else geometric",
        default="geometric",
    )
    parts: Literal["search", "auto"] | Annotated[int, Field(ge=1, le=10_000)] = _option(
        "which parts faces and charts belong to; search: those that the charts were searched in; "
        "auto: as many as people would name; or their number; with repack, search means primitives",
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
    border_texels: float | None = _option(
        "least distance of a chart to the edge of its tile; none: half the gutter",
        unit="texels",
        default=None,
        ge=0.0,
        le=1024.0,
    )
    mip_levels: int = _option(
        "halvings of the texture at which gutter and border still hold; each doubles them",
        default=0,
        ge=0,
        le=10,
    )
    snap_to_texels: bool = _option(
        "put the lower left corner of every chart's box on a corner of texels", default=False
    )
    rotations: int = _option(
        "turns of a chart that the first packing passes try (later ones turn freely)",
        default=4,
        ge=4,
        le=32,
    )
    texel_density: float | None = _option(
        "texels per unit of length of the model, over as many tiles as that takes; none: one scale "
        "that fills the tiles",
        unit="texels per unit",
        default=None,
        gt=0.0,
        le=1e9,
    )
    texel_weights: tuple[str, ...] = _option(
        "more or fewer texels along a unit of length for what is named, others having 1: "
        "material:NAME=2, part:3=0.5 (numbers as in the report); a chart over several materials "
        "takes the largest",
        default=(),
        max_length=1000,
    )
    group_by_part: Literal["none", "near", "strict"] = _option(
        "near: charts of a part lie together where that costs at most 5 % of the texels; strict: "
        "in an upright rectangle of their own",
        default="none",
    )
    tiles: Literal["per_part"] | Annotated[int, Field(ge=1, le=100)] = _option(
        "texture tiles to spread the parts over, evenly by area; per_part: one for each part",
        default=1,
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
    compress: Literal["none", "meshopt", "draco"] = _option(
        "how the geometry of the result is stored, always without loss; meshopt makes it smaller",
        default="none",
    )
    deadline_s: float | None = _option(
        "seconds after which the best atlas found so far is completed; none: take the time needed",
        unit="seconds",
        default=None,
        gt=0.0,
    )

    @model_validator(mode="after")
    def _fit_each_other(self) -> UnwrapOptions:
        """Refuse combinations that ask for two things at once, or for nothing at all."""
        for name in _ONLY_IN_UNWRAP if self.mode == "repack" else _ONLY_IN_REPACK:
            if self._is_set(name):
                raise _ClashError(name, f"has no meaning with mode: {self.mode}")
        fixed, several = self.texel_density is not None, self.tiles != 1
        if fixed and several:
            raise _ClashError(
                "tiles", "texel_density takes as many tiles as it needs: leave out tiles"
            )
        if fixed and self.group_by_part != "none":
            raise _ClashError("group_by_part", "charts of a fixed texel_density cannot be grouped")
        if fixed and self._is_set("cut_below_efficiency"):
            raise _ClashError(
                "cut_below_efficiency", "no chart decides the scale where texel_density does"
            )
        if self.tiles == "per_part" and self.group_by_part != "none":
            raise _ClashError("group_by_part", "tiles: per_part groups by part already")
        if self.scope == "mesh" and (fixed or several):
            name = "texel_density" if fixed else "tiles"
            raise _ClashError(name, "scope: mesh gives each mesh one tile of its own")
        try:
            weights = self.weights()
        except ValueError as failure:
            raise _ClashError("texel_weights", str(failure)) from failure
        if weights.part and self.scope == "mesh":
            raise _ClashError("texel_weights", "scope: mesh numbers the parts of each mesh anew")
        gutter = self.gutter_texels * 2**self.mip_levels
        border = self.gutter_texels / 2 if self.border_texels is None else self.border_texels
        border *= 2**self.mip_levels
        if gutter > self.resolution / 4 or border > self.resolution * 0.374:
            name = "mip_levels" if self.mip_levels else "gutter_texels"
            raise _ClashError(
                name,
                f"a gutter of {gutter:g} and a border of {border:g} texels leave no room at "
                f"resolution {self.resolution}",
            )
        return self

    def _is_set(self, name: str) -> bool:
        return bool(getattr(self, name) != type(self).model_fields[name].default)

    def weights(self) -> TexelWeights:
        """`texel_weights`, read."""
        return read_texel_weights(self.texel_weights)

    @classmethod
    def parse(cls, values: dict[str, Any]) -> UnwrapOptions:
        """Validate untrusted values; raises `OptionError` with the name of the first bad option."""
        try:
            return cls.model_validate(values)
        except ValidationError as failure:
            first = failure.errors(include_url=False)[0]
            clash = first.get("ctx", {}).get("error")
            if isinstance(clash, _ClashError):
                message = f"option {clash.option}: {clash}"
                raise OptionError(message, pointer=f"/{clash.option}") from failure
            name = str(first["loc"][0]) if first["loc"] else ""
            raise OptionError(f"option {name}: {first['msg']}", pointer=f"/{name}") from failure
