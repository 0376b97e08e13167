"""Fuzzing of the engine's binding: `python -m tests.fuzz.fuzz_engine`.

Whatever mesh comes, the engine either refuses it with an `EngineError`, or every corner gets a
finite UV in the unit square. Arguments are those of libFuzzer, such as -max_total_time=60.
"""

from __future__ import annotations

import sys

import atheris
import numpy as np
import partuv_engine

COORDINATES = [0.0, 1.0, -1.0, 0.5, 2.0, 1e-6, 1e6, 1e-30, 1e30, 1e300, float("nan"), float("inf")]
FINITE = 8  # of the coordinates, those of ordinary size
TRIALS_PER_MESH = 0.5  # seconds


def mesh(provider: atheris.FuzzedDataProvider) -> tuple[np.ndarray, np.ndarray]:
    """A few points and faces, some of them odd."""
    count = provider.ConsumeIntInRange(0, 24)
    last = len(COORDINATES) - 1 if provider.ConsumeIntInRange(0, 9) == 0 else FINITE - 1
    picks = [provider.ConsumeIntInRange(0, last) for _ in range(3 * count)]
    positions = np.array([COORDINATES[pick] for pick in picks], np.float64).reshape(-1, 3)
    if provider.ConsumeBool():
        positions += np.arange(3 * count).reshape(-1, 3) % 7 * 0.25
    highest = count if provider.ConsumeIntInRange(0, 19) == 0 else max(count - 1, 0)
    corners = 3 * provider.ConsumeIntInRange(0, 60)
    faces = [provider.ConsumeIntInRange(-1 if highest == count else 0, highest)
             for _ in range(corners)]  # fmt: skip
    return positions, np.array(faces, np.int32).reshape(-1, 3)


def options(provider: atheris.FuzzedDataProvider) -> partuv_engine.Options:
    """Options, now and then beyond their range."""
    chosen = partuv_engine.Options()
    chosen.max_area_distortion = provider.ConsumeIntInRange(95, 300) / 100
    chosen.min_angular = provider.ConsumeIntInRange(0, 100) / 100
    chosen.resolution = provider.ConsumeIntInRange(0, 2048)
    chosen.gutter_texels = provider.ConsumeIntInRange(-1, 64)
    chosen.denoise = provider.ConsumeIntInRange(-1, 2) / 2
    chosen.profile = partuv_engine.Profile["balanced" if provider.ConsumeBool() else "conformal"]
    chosen.flattening = partuv_engine.Flattener["abf" if provider.ConsumeBool() else "lscm"]
    return chosen


def one_input(data: bytes) -> None:
    """Unwrap one mesh and look at every corner."""
    provider = atheris.FuzzedDataProvider(data)
    positions, faces = mesh(provider)
    context = partuv_engine.Context(threads=1, deadline_s=TRIALS_PER_MESH)
    try:
        atlas = partuv_engine.unwrap(positions, faces, options(provider), context)
    except partuv_engine.EngineError:
        return
    uv = atlas.corner_uv
    if uv.shape != (len(faces), 3, 2) or len(atlas.chart) != len(faces):
        raise AssertionError("not one UV per corner")
    if not (np.isfinite(uv).all() and uv.min() >= 0 and uv.max() <= 1):
        raise AssertionError("a UV outside the unit square")
    if (uv * 2.0**24 % 1).any():
        raise AssertionError("a UV off the grid of 2^-24")


if __name__ == "__main__":
    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()
