"""GLB in, the same GLB with an atlas out."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from typing import NamedTuple

import partuv_engine
from partuv_contract.errors import (
    CancelledError,
    NoAreaError,
    NonFinitePositionError,
    NoTrianglesError,
    OptionError,
    PartuvError,
)
from partuv_contract.options import UnwrapOptions
from partuv_contract.report import ChartFigures, UnwrapReport

from partuv_worker.glb.limits import DEFAULT_LIMITS, Limits
from partuv_worker.glb.scene import Scene
from partuv_worker.glb.soup import TriangleSoup
from partuv_worker.measure import measure_atlas
from partuv_worker.preview import draw_atlas

# Shares of the bar; reading and writing are short beside the engine's work.
_READ_UNTIL = 0.02
_ENGINE_UNTIL = 0.97


class Progress(NamedTuple):
    """How far an unwrap is."""

    fraction: float  # 0 to 1, never falls
    stage: str


@dataclass(frozen=True)
class UnwrapResult:
    """The finished asset and what can be said about it."""

    glb: bytes
    report: UnwrapReport
    atlas: partuv_engine.Atlas

    def preview_png(self, size_texels: int = 1024) -> bytes:
        """The atlas as a picture, drawn when it is asked for."""
        atlas = self.atlas
        return draw_atlas(atlas.corner_uv, atlas.chart, atlas.part, atlas.tile, size_texels)


class Unwrap:
    """One run of the pipeline; progress and cancel may be called from any thread."""

    def __init__(
        self, options: UnwrapOptions, *, threads: int = 1, limits: Limits = DEFAULT_LIMITS
    ) -> None:
        self._options = options
        self._threads = threads
        self._limits = limits
        self._cancelled = threading.Event()
        self._context: partuv_engine.Context | None = None
        self._stage = Progress(0.0, "reading")
        self._seconds: dict[str, float] = {}

    @property
    def progress(self) -> Progress:
        """How far the run is."""
        context, stage = self._context, self._stage
        if context is None or stage.stage != "unwrapping":
            return stage
        fraction, name = context.progress
        return Progress(_READ_UNTIL + fraction * (_ENGINE_UNTIL - _READ_UNTIL), name or "starting")

    def cancel(self) -> None:
        """Ask the run to stop; it then raises `CancelledError` within a fraction of a second."""
        self._cancelled.set()
        context = self._context
        if context is not None:
            context.cancel()

    def run(self, data: bytes) -> UnwrapResult:
        """Unwrap one GLB; raises a `PartuvError` that says why it could not be done."""
        started = time.monotonic()
        with self._timed("reading"):
            scene = Scene(data, self._limits)
        deadline_s = self._options.deadline_s
        left_s = None if deadline_s is None else max(deadline_s - time.monotonic() + started, 0.0)
        self._context = partuv_engine.Context(threads=self._threads, deadline_s=left_s)
        self._enter(_READ_UNTIL, "unwrapping")
        atlas = self._call_engine(scene.soup, self._context)
        self._enter(_ENGINE_UNTIL, "writing")
        with self._timed("writing"):
            glb = scene.write(atlas.corner_uv)
            self._enter(_ENGINE_UNTIL, "measuring")
        with self._timed("measuring"):
            figures = measure_atlas(
                scene.soup.positions, scene.soup.faces, atlas.corner_uv, atlas.chart
            )
        table = atlas.charts
        areas = table["area_3d"]
        report = UnwrapReport(
            version=version("partuv-service"),
            input_bytes=len(data),
            output_bytes=len(glb),
            primitives=len(scene.soup.pieces),
            faces=len(scene.soup.faces),
            chart_count=len(areas),
            part_count=atlas.part_count,
            tile_count=int(atlas.tile.max()) + 1,
            area_distortion_worst=float(table["area_distortion"].max()),
            area_distortion_mean=figures.area_distortion_mean,
            angular_mean=figures.angular_mean,
            seam_length=figures.seam_length,
            packing_efficiency=atlas.efficiency,
            noise=atlas.noise,
            seconds=self._seconds,
            charts=[
                ChartFigures(
                    faces=int(table["faces"][row]),
                    part=int(table["part"][row]),
                    tile=int(table["tile"][row]),
                    area_share=float(areas[row] / areas.sum()),
                    area_distortion=float(table["area_distortion"][row]),
                    angular=float(table["angular"][row]),
                )
                for row in range(len(areas))
            ],
        )
        self._enter(1.0, "done")
        return UnwrapResult(glb, report, atlas)

    def _call_engine(
        self, soup: TriangleSoup, context: partuv_engine.Context
    ) -> partuv_engine.Atlas:
        try:
            atlas = partuv_engine.unwrap(
                soup.positions, soup.faces, engine_options(self._options), context
            )
        except partuv_engine.EngineError as failure:
            raise _translated(failure) from failure
        self._seconds |= dict(atlas.stage_seconds)
        return atlas

    def _enter(self, fraction: float, stage: str) -> None:
        if self._cancelled.is_set():
            raise CancelledError("the unwrap was cancelled")
        self._stage = Progress(fraction, stage)

    @contextmanager
    def _timed(self, stage: str) -> Iterator[None]:
        started = time.monotonic()
        yield
        self._seconds[stage] = time.monotonic() - started


def unwrap_glb(
    data: bytes,
    options: UnwrapOptions | None = None,
    *,
    threads: int = 1,
    limits: Limits = DEFAULT_LIMITS,
) -> UnwrapResult:
    """Unwrap one GLB and wait for it."""
    return Unwrap(options or UnwrapOptions(), threads=threads, limits=limits).run(data)


def engine_options(options: UnwrapOptions) -> partuv_engine.Options:
    """The options in the engine's own terms."""
    denoise = {"auto": -1.0, "off": 0.0}
    engine = partuv_engine.Options()
    engine.max_area_distortion = options.max_area_distortion
    engine.min_angular = options.min_angular
    engine.profile = partuv_engine.Profile[options.profile]
    engine.flattening = partuv_engine.Flattener[options.flattening]
    engine.denoise = (
        denoise[options.denoise] if isinstance(options.denoise, str) else options.denoise
    )
    engine.resolution = options.resolution
    engine.gutter_texels = options.gutter_texels
    return engine


def _translated(failure: partuv_engine.EngineError) -> PartuvError:
    """An engine's refusal as an error of the contract."""
    known: dict[str, PartuvError] = {
        "cancelled": CancelledError("the unwrap was cancelled"),
        "empty_mesh": NoTrianglesError("the scene has no triangles"),
        "non_finite_position": NonFinitePositionError(f"a position is not finite: {failure.where}"),
        "no_face_with_area": NoAreaError("every triangle is degenerate: there is no surface"),
        "invalid_option": OptionError(f"the engine refuses an option: {failure.where}"),
    }
    return known.get(failure.code, PartuvError(f"the engine failed: {failure}"))
