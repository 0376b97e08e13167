"""GLB in, the same GLB with an atlas out."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.metadata import version
from typing import NamedTuple

import numpy as np
import partuv_engine
from partuv_contract.errors import CancelledError
from partuv_contract.options import UnwrapOptions
from partuv_contract.report import ChartFigures, FeaturesFigures, TileFigures, UnwrapReport

from partuv_worker.atlas_svg import draw_atlas_svg
from partuv_worker.engine_call import Atlas, unwrap_soup
from partuv_worker.features import PriorResult, Priors
from partuv_worker.glb.limits import DEFAULT_LIMITS, Limits
from partuv_worker.glb.scene import Scene
from partuv_worker.glb.soup import TriangleSoup
from partuv_worker.measure import measure_atlas
from partuv_worker.parts.coloured import coloured_glb
from partuv_worker.parts.figures import charted_part_figures
from partuv_worker.preview import draw_atlas
from partuv_worker.progress import Progress
from partuv_worker.repack.call import folded_charts, repack_soup
from partuv_worker.udim import in_udim, udim_extras, udim_number

# Shares of the bar; reading and writing are short beside the engine's work.
_READ_UNTIL = 0.02
# A learned prior takes as long as the engine on many meshes; the geometric one takes nothing.
_FEATURES_UNTIL = 0.4
_ENGINE_UNTIL = 0.97


class _EngineCall(NamedTuple):
    """A call under way and the part of the whole bar that it fills."""

    context: partuv_engine.Context
    start: float
    share: float


@dataclass(frozen=True)
class UnwrapResult:
    """The finished asset and what can be said about it."""

    glb: bytes
    report: UnwrapReport
    atlas: Atlas
    soup: TriangleSoup

    def parts_glb(self) -> bytes:
        """The surface coloured by part, made when it is asked for."""
        return coloured_glb(self.soup.positions, self.soup.faces, self.atlas.part)

    def preview_png(self, size_texels: int = 1024) -> bytes:
        """The atlas as a picture, drawn when it is asked for."""
        atlas = self.atlas
        return draw_atlas(atlas.corner_uv, atlas.chart, atlas.part, atlas.tile, size_texels)

    def preview_svg(self) -> bytes:
        """The atlas as vectors."""
        atlas = self.atlas
        return draw_atlas_svg(atlas.corner_uv, atlas.chart, atlas.part, atlas.tile)


class Unwrap:
    """One run of the pipeline; progress and cancel may be called from any thread."""

    def __init__(
        self,
        options: UnwrapOptions,
        *,
        threads: int = 1,
        limits: Limits = DEFAULT_LIMITS,
        priors: Priors | None = None,
    ) -> None:
        self._options = options
        self._priors = priors or Priors()
        self._threads = threads
        self._limits = limits
        self._cancelled = threading.Event()
        self._state: Progress | _EngineCall = Progress(0.0, "reading")
        self._engine_from = 0.0
        self._seconds: dict[str, float] = {}

    @property
    def progress(self) -> Progress:
        """How far the run is."""
        state = self._state
        if isinstance(state, Progress):
            return state
        fraction, stage = state.context.progress
        waiting = "starting" if self._options.mode == "unwrap" else "packing"
        return Progress(state.start + fraction * state.share, stage or waiting)

    def cancel(self) -> None:
        """Ask the run to stop; it then raises `CancelledError` within a fraction of a second."""
        self._cancelled.set()
        state = self._state
        if isinstance(state, _EngineCall):
            state.context.cancel()

    def run(self, data: bytes) -> UnwrapResult:
        """Unwrap one GLB; raises a `PartuvError` that says why it could not be done."""
        started = time.monotonic()
        options = self._options
        with self._timed("reading"):
            self._check_cancelled()
            scene = Scene(data, self._limits, options.only)
            given_uv = scene.existing_uv() if options.mode == "repack" else None
            weight = scene.face_weights(options.weights().material)
        parts, notes = self._parts(scene.soup)
        features = None if parts is None else parts.features
        deadline_s = options.deadline_s
        left_s = None if deadline_s is None else max(deadline_s - time.monotonic() + started, 0.0)
        if given_uv is None:
            atlas = unwrap_soup(scene.soup, features, weight, options, left_s, self._next_call)
        else:
            atlas = repack_soup(
                scene.soup, given_uv, features, weight, options, left_s, self._next_call
            )
            notes += _folds(folded_charts(given_uv, atlas.chart))
        self._seconds |= atlas.seconds
        notes += _missed_gutters(atlas, options)
        with self._timed("writing"):
            glb = self._written(scene, atlas)
        with self._timed("measuring"):
            report = self._report(len(data), len(glb), scene, atlas, parts, notes)
        self._state = Progress(1.0, "done")
        report = report.model_copy(update={"seconds": self._seconds})
        return UnwrapResult(glb, report, atlas, scene.soup)

    def _written(self, scene: Scene, atlas: Atlas) -> bytes:
        """The file. Tiles of one atlas share a UV space, those of several meshes do not."""
        options, tile_count = self._options, len(atlas.tiles["charts"])
        corner_uv, extras = atlas.corner_uv, None
        if options.scope == "scene" and tile_count > 1:
            corner_uv = in_udim(corner_uv, atlas.tile)
            extras = udim_extras(tile_count)
        return scene.write(
            corner_uv,
            options.existing_uv,
            compress=options.compress,
            extras=extras,
        )

    def _parts(self, soup: TriangleSoup) -> tuple[PriorResult | None, tuple[str, ...]]:
        """The grounds of the part tree, for the whole scene at once, and notes for the report.

        Without grounds there is no tree: repacking needs one only for parts that are asked for.
        """
        choice = self._options.features
        if self._options.mode == "repack" and self._options.parts == "search":
            return None, ()
        until = _READ_UNTIL if choice == "geometric" else _FEATURES_UNTIL

        def progress(done: float) -> None:
            self._state = Progress(_READ_UNTIL + (until - _READ_UNTIL) * done, "part features")
            self._check_cancelled()

        progress(0.0)
        prior, notes = self._priors.choose(choice)
        result = prior.parts(soup.positions, soup.faces, threads=self._threads, progress=progress)
        if result.features is not None:
            self._seconds["features"] = result.seconds
        return result, notes

    def _next_call(self, share: float, deadline_s: float | None) -> partuv_engine.Context:
        """The context of an engine call that does this share of all faces."""
        state = self._state
        if isinstance(state, _EngineCall):
            start = state.start + state.share
        else:
            self._engine_from = start = state.fraction
        context = partuv_engine.Context(threads=self._threads, deadline_s=deadline_s)
        self._state = _EngineCall(context, start, share * (_ENGINE_UNTIL - self._engine_from))
        self._check_cancelled()  # after the state is set: a cancel from now on finds the context
        return context

    def _report(
        self,
        input_bytes: int,
        output_bytes: int,
        scene: Scene,
        atlas: Atlas,
        parts: PriorResult | None,
        notes: Sequence[str],
    ) -> UnwrapReport:
        soup, table = scene.soup, atlas.charts
        figures = measure_atlas(soup.positions, soup.faces, atlas.corner_uv, atlas.chart)
        areas = table["area_3d"] / table["area_3d"].sum()
        rows = zip(
            table["faces"].tolist(),
            table["part"].tolist(),
            table["tile"].tolist(),
            areas.tolist(),
            table["area_distortion"].tolist(),
            table["angular"].tolist(),
            strict=True,
        )
        return UnwrapReport(
            version=version("partuv-service"),
            mode=self._options.mode,
            input_bytes=input_bytes,
            output_bytes=output_bytes,
            primitives=len(soup.pieces),
            faces=len(soup.faces),
            chart_count=len(areas),
            part_count=atlas.part_count,
            tile_count=len(atlas.tiles["charts"]),
            area_distortion_worst=float(table["area_distortion"].max()),
            area_distortion_mean=figures.area_distortion_mean,
            angular_mean=figures.angular_mean,
            seam_length=figures.seam_length,
            packing_efficiency=atlas.efficiency,
            noise=atlas.noise,
            features=None if parts is None else _features_figures(parts),
            notes=list(notes),
            seconds={},
            charts=[
                ChartFigures(
                    faces=faces,
                    part=part,
                    tile=tile,
                    area_share=area,
                    area_distortion=distortion,
                    angular=angular,
                )
                for faces, part, tile, area, distortion, angular in rows
            ],
            parts=charted_part_figures(soup, atlas.part, atlas.chart),
            tiles=self._tiles(atlas),
        )

    def _check_cancelled(self) -> None:
        if self._cancelled.is_set():
            raise CancelledError("the unwrap was cancelled")

    def _tiles(self, atlas: Atlas) -> list[TileFigures]:
        table, shared = atlas.tiles, self._options.scope == "scene"
        rows = zip(*(table[key].tolist() for key in table), strict=True)
        named = [dict(zip(table, row, strict=True)) for row in rows]
        return [
            TileFigures(
                udim=udim_number(tile) if shared else None,
                charts=row["charts"],
                packing_efficiency=row["efficiency"],
                covered_texels=round(row["covered_texels"]),
                gutter_texels=row["gutter_texels"] if np.isfinite(row["gutter_texels"]) else None,
                seconds=row["seconds"],
            )
            for tile, row in enumerate(named)
        ]

    @contextmanager
    def _timed(self, stage: str) -> Iterator[None]:
        """Show a stage of our own in the progress, and keep how long it took."""
        self._check_cancelled()
        if stage != "reading":
            self._state = Progress(_ENGINE_UNTIL, stage)
        started = time.monotonic()
        yield
        self._seconds[stage] = time.monotonic() - started


def _features_figures(parts: PriorResult) -> FeaturesFigures:
    return FeaturesFigures(prior=parts.name, version=parts.version, seconds=parts.seconds)


def _folds(charts: int) -> tuple[str, ...]:
    """A note on charts that are kept though they are folded over."""
    return (f"{charts} of the kept charts are folded over: their texels are used twice",) * (
        charts > 0
    )


def _missed_gutters(atlas: Atlas, options: UnwrapOptions) -> tuple[str, ...]:
    """A note for every tile with more charts than fit it at the gutter, however small."""
    asked = options.gutter_texels * 2**options.mip_levels
    return tuple(
        f"tile {udim_number(tile) if options.scope == 'scene' else tile}: its {charts} charts lie "
        f"{reached:.3g} texels apart instead of {asked:g}, as no more fit: raise the resolution"
        for tile, (charts, reached) in enumerate(
            zip(atlas.tiles["charts"], atlas.tiles["gutter_texels"], strict=True)
        )
        if reached < asked
    )


def unwrap_glb(
    data: bytes,
    options: UnwrapOptions | None = None,
    *,
    threads: int = 1,
    limits: Limits = DEFAULT_LIMITS,
    priors: Priors | None = None,
) -> UnwrapResult:
    """Unwrap one GLB and wait for it."""
    options = options or UnwrapOptions()
    return Unwrap(options, threads=threads, limits=limits, priors=priors).run(data)
