"""Calling the engine: once for a scene, or once per mesh and the results put together."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import partuv_engine
from numpy.typing import NDArray
from partuv_contract.errors import (
    CancelledError,
    NoAreaError,
    NonFinitePositionError,
    NoTrianglesError,
    OptionError,
    PartuvError,
)
from partuv_contract.options import UnwrapOptions

from partuv_worker.glb.soup import TriangleSoup

ContextMaker = Callable[[float, float | None], partuv_engine.Context]
"""Makes the context of the next call, given its share of all faces and its deadline in seconds."""

MeshCall = Callable[[TriangleSoup, slice, partuv_engine.Context], "Atlas"]
"""Makes the atlas of one mesh; the slice tells which faces of the whole soup it has."""


@dataclass(frozen=True)
class Atlas:
    """What came out of one or several calls. Charts and parts are numbered through."""

    corner_uv: NDArray[np.float32]  # F x 3 x 2, V up
    chart: NDArray[np.int32]  # F
    part: NDArray[np.int32]  # F
    tile: NDArray[np.int32]  # F
    charts: dict[str, NDArray[Any]]  # one array per figure, a row per chart
    tiles: dict[str, NDArray[Any]]  # one array per figure, a row per tile
    part_count: int
    efficiency: float
    noise: float | None
    seconds: dict[str, float]


def unwrap_soup(
    soup: TriangleSoup,
    features: NDArray[np.float32] | None,
    weight: NDArray[np.float64] | None,
    options: UnwrapOptions,
    deadline_s: float | None,
    make_context: ContextMaker,
) -> Atlas:
    """Unwrap all of a soup; raises a `PartuvError` if the engine refuses it.

    The part tree is made of the features (F x d), without them by the engine alone. The weights
    (F) are texel densities relative to other faces.
    """

    def call(mesh: TriangleSoup, own: slice, context: partuv_engine.Context) -> Atlas:
        engine = engine_options(options)
        if weight is not None:
            engine.texel_weights.face = weight[own].tolist()
        return _call(mesh, None if features is None else features[own], engine, context)

    return for_each_mesh(soup, options.scope, deadline_s, make_context, call)


def for_each_mesh(
    soup: TriangleSoup,
    scope: Literal["scene", "mesh"],
    deadline_s: float | None,
    make_context: ContextMaker,
    call: MeshCall,
) -> Atlas:
    """One atlas of one call, or with `mesh` of one per mesh.

    Each mesh then gets tiles of its own, and its share of the deadline by its faces.
    """
    soups = soup.by_mesh() if scope == "mesh" else [soup]
    started = time.monotonic()
    atlases: list[Atlas] = []
    faces_left = len(soup.faces)
    for mesh in soups:
        first = len(soup.faces) - faces_left
        left_s = None
        if deadline_s is not None:
            left_s = max(deadline_s - (time.monotonic() - started), 0.0)
            left_s *= len(mesh.faces) / faces_left
        context = make_context(len(mesh.faces) / len(soup.faces), left_s)
        try:
            atlases.append(call(mesh, slice(first, first + len(mesh.faces)), context))
        except NoAreaError:
            atlases.append(_without_area(len(mesh.faces)))
        faces_left -= len(mesh.faces)
    joined = _joined(atlases)
    if not joined.charts["area_3d"].any():
        raise NoAreaError("every triangle is degenerate: there is no surface")
    return joined


def _call(
    soup: TriangleSoup,
    features: NDArray[np.float32] | None,
    options: partuv_engine.Options,
    context: partuv_engine.Context,
) -> Atlas:
    try:
        atlas = partuv_engine.unwrap(
            soup.positions, soup.faces, options, context, features=features
        )
    except partuv_engine.EngineError as failure:
        raise translated(failure) from failure
    return Atlas(
        corner_uv=atlas.corner_uv,
        chart=atlas.chart,
        part=atlas.part,
        tile=atlas.tile,
        charts=atlas.charts,
        tiles=atlas.tiles,
        part_count=atlas.part_count,
        efficiency=atlas.efficiency,
        noise=atlas.noise,
        seconds=dict(atlas.stage_seconds),
    )


_EMPTY_TILE = {
    "charts": 1,
    "efficiency": 0.0,
    "covered_texels": 0.0,
    "gutter_texels": np.inf,
    "seconds": 0.0,
}


def _without_area(face_count: int) -> Atlas:
    """One chart for a mesh that has no surface: all its corners in the middle of its tile."""
    zeros = np.zeros(face_count, np.int32)
    figures = {"faces": face_count, "part": 0, "tile": 0}
    measures = {"area_3d": 0.0, "area_distortion": 1.0, "angular": 1.0}
    return Atlas(
        corner_uv=np.full((face_count, 3, 2), 0.5, np.float32),
        chart=zeros,
        part=zeros,
        tile=zeros,
        charts={key: np.array([value]) for key, value in (figures | measures).items()},
        tiles={key: np.array([value]) for key, value in _EMPTY_TILE.items()},
        part_count=1,
        efficiency=0.0,
        noise=None,
        seconds={},
    )


def _joined(atlases: Sequence[Atlas]) -> Atlas:
    charts = np.cumsum([0, *(len(atlas.charts["faces"]) for atlas in atlases)])
    parts = np.cumsum([0, *(atlas.part_count for atlas in atlases)])
    tiles = np.cumsum([0, *(int(atlas.tile.max()) + 1 for atlas in atlases)])
    tables = [
        atlas.charts
        | {"part": atlas.charts["part"] + first_part, "tile": atlas.charts["tile"] + first_tile}
        for atlas, first_part, first_tile in zip(atlases, parts, tiles, strict=False)
    ]
    seconds: dict[str, float] = {}
    for atlas in atlases:
        for stage, spent in atlas.seconds.items():
            seconds[stage] = seconds.get(stage, 0.0) + spent
    return Atlas(
        corner_uv=np.concatenate([atlas.corner_uv for atlas in atlases]),
        chart=_numbered([atlas.chart for atlas in atlases], charts),
        part=_numbered([atlas.part for atlas in atlases], parts),
        tile=_numbered([atlas.tile for atlas in atlases], tiles),
        charts={key: np.concatenate([table[key] for table in tables]) for key in tables[0]},
        tiles={key: np.concatenate([atlas.tiles[key] for atlas in atlases]) for key in _EMPTY_TILE},
        part_count=int(parts[-1]),
        efficiency=float(np.mean([atlas.efficiency for atlas in atlases])),
        noise=max((atlas.noise for atlas in atlases if atlas.noise is not None), default=None),
        seconds=seconds,
    )


def _numbered(arrays: Sequence[NDArray[np.int32]], firsts: NDArray[Any]) -> NDArray[np.int32]:
    """Numbers that go on from one array to the next."""
    shifted = [array + first for array, first in zip(arrays, firsts[:-1], strict=True)]
    return np.concatenate(shifted).astype(np.int32)


def engine_options(options: UnwrapOptions) -> partuv_engine.Options:
    """The options in the engine's own terms."""
    denoise = {"auto": -1.0, "off": 0.0}
    parts = {"search": -1, "auto": 0}
    engine = partuv_engine.Options()
    engine.max_area_distortion = options.max_area_distortion
    engine.min_angular = options.min_angular
    engine.profile = partuv_engine.Profile[options.profile]
    engine.flattening = partuv_engine.Flattener[options.flattening]
    engine.quality = partuv_engine.Quality[options.quality]
    engine.denoise = (
        denoise[options.denoise] if isinstance(options.denoise, str) else options.denoise
    )
    engine.parts = parts[options.parts] if isinstance(options.parts, str) else options.parts
    engine.cut_below_efficiency = options.cut_below_efficiency
    engine.resolution = options.resolution
    engine.gutter_texels = options.gutter_texels
    engine.border_texels = -1.0 if options.border_texels is None else options.border_texels
    engine.mip_levels = options.mip_levels
    engine.snap_to_texels = options.snap_to_texels
    engine.rotations = options.rotations
    engine.texel_density = options.texel_density or 0.0
    engine.texel_weights.part = list(options.weights().part.items())
    engine.group_by_part = partuv_engine.Grouping[options.group_by_part]
    engine.tiles = 0 if options.tiles == "per_part" else options.tiles
    return engine


def translated(failure: partuv_engine.EngineError) -> PartuvError:
    """An engine's refusal as an error of the contract."""
    option, colon, _ = failure.where.partition(":")
    known: dict[str, PartuvError] = {
        "cancelled": CancelledError("the unwrap was cancelled"),
        "empty_mesh": NoTrianglesError("the scene has no triangles"),
        "non_finite_position": NonFinitePositionError(f"a position is not finite: {failure.where}"),
        "no_face_with_area": NoAreaError("every triangle is degenerate: there is no surface"),
        "invalid_option": OptionError(
            f"the engine refuses an option: {failure.where}",
            pointer=f"/{option}" if colon else None,
        ),
    }
    return known.get(failure.code, PartuvError(f"the engine failed: {failure}"))
