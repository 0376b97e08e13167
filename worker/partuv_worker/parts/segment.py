"""The parts of a GLB without an unwrap."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.metadata import version
from typing import Literal

import numpy as np
import partuv_engine
from numpy.typing import NDArray
from partuv_contract.errors import CancelledError
from partuv_contract.report import FeaturesFigures, SegmentReport

from partuv_worker.engine_call import translated
from partuv_worker.features import FeaturesChoice, Priors
from partuv_worker.glb.limits import DEFAULT_LIMITS, Limits
from partuv_worker.glb.scene import Scene
from partuv_worker.glb.soup import TriangleSoup
from partuv_worker.parts.coloured import coloured_glb
from partuv_worker.parts.figures import part_figures
from partuv_worker.progress import Progress

_FEATURES_UNTIL = 0.8  # of the bar; nothing else takes long beside a learned prior


@dataclass(frozen=True)
class SegmentResult:
    """The part of every triangle of the scene, in the order in which the file has them."""

    part: NDArray[np.int32]  # F
    report: SegmentReport
    soup: TriangleSoup

    def parts_glb(self) -> bytes:
        """The surface coloured by part."""
        return coloured_glb(self.soup.positions, self.soup.faces, self.part)


def cut_parts(
    soup: TriangleSoup,
    features: NDArray[np.float32] | None,
    parts: Literal["auto"] | int,
    context: partuv_engine.Context,
) -> NDArray[np.int32]:
    """The part of each face, by the features of the faces (F x d) or by the geometry alone."""
    try:
        surface = partuv_engine.Surface(soup.positions, soup.faces, canonical=True)
        if features is not None:
            rows = np.ascontiguousarray(features[surface.source_face])
            tree = partuv_engine.build_ward_tree(surface, rows, context)
        else:
            surface = surface.denoised(None, context)
            tree = partuv_engine.build_part_tree(surface, context)
        if parts == "auto":
            return partuv_engine.cut_tree_auto(surface, tree)
        return partuv_engine.cut_tree(surface, tree, parts)
    except partuv_engine.EngineError as failure:
        raise translated(failure) from failure


class Segment:
    """One run; progress and cancel may be called from any thread."""

    def __init__(
        self,
        parts: Literal["auto"] | int,
        *,
        features: FeaturesChoice = "geometric",
        only: Sequence[str] = (),
        threads: int = 1,
        limits: Limits = DEFAULT_LIMITS,
        priors: Priors | None = None,
    ) -> None:
        self._parts = parts
        self._features: FeaturesChoice = features
        self._only = only
        self._threads = threads
        self._limits = limits
        self._priors = priors or Priors()
        self._context = partuv_engine.Context(threads=threads)
        self._cancelled = threading.Event()
        self._progress = Progress(0.0, "reading")

    @property
    def progress(self) -> Progress:
        """How far the run is."""
        return self._progress

    def cancel(self) -> None:
        """Ask the run to stop; it then raises `CancelledError`."""
        self._cancelled.set()
        self._context.cancel()

    def run(self, data: bytes) -> SegmentResult:
        """Segment one GLB; raises a `PartuvError` that says why it could not be done."""
        started = time.monotonic()
        soup = Scene(data, self._limits, self._only).soup
        prior, notes = self._priors.choose(self._features)
        grounds = prior.parts(
            soup.positions, soup.faces, threads=self._threads, progress=self._tell
        )
        self._tell(1.0)
        part = cut_parts(soup, grounds.features, self._parts, self._context)
        self._tell(1.0)
        figures = part_figures(soup, part)
        report = SegmentReport(
            version=version("partuv-service"),
            faces=len(part),
            part_count=len(figures),
            parts=figures,
            features=FeaturesFigures(
                prior=grounds.name, version=grounds.version, seconds=grounds.seconds
            ),
            notes=list(notes),
            seconds=time.monotonic() - started,
        )
        self._progress = Progress(1.0, "done")
        return SegmentResult(part, report, soup)

    def _tell(self, features_done: float) -> None:
        if self._cancelled.is_set():
            raise CancelledError("the segmentation was cancelled")
        stage = "part features" if features_done < 1.0 else "parts"
        self._progress = Progress(_FEATURES_UNTIL * features_done, stage)
