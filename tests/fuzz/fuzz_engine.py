"""Fuzzing of the engine's binding: `python -m tests.fuzz.fuzz_engine`.

Whatever mesh comes, the engine either refuses it with an `EngineError`, or every corner gets a
finite UV in the unit square. The input seeds a generator of odd meshes: libFuzzer does not see
into native code. Arguments are those of libFuzzer, such as -max_total_time=60.
"""

from __future__ import annotations

import sys

import atheris
import numpy as np
import partuv_engine

ORDINARY = [0.0, 1.0, -1.0, 0.5, 2.0, 0.25]
EXTREME = [*ORDINARY, 1e-6, 1e6, 1e-30, 1e30]
BROKEN = [*EXTREME, 1e300, float("nan"), float("inf")]
DEADLINE_S = 0.5


def mesh(random: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A few points and faces: noise on a palette of coordinates, or a sheet with damage."""
    palette = (ORDINARY, ORDINARY, EXTREME, BROKEN)[random.integers(4)]
    if random.random() < 0.5:
        count = int(random.integers(1, 24))
        positions = random.choice(palette, (count, 3))
        if random.random() < 0.5:
            positions = positions + random.normal(0, 0.3, positions.shape)
        beyond = random.random() < 0.05
        faces = random.integers(-1 if beyond else 0, count + beyond, (random.integers(0, 60), 3))
        return positions, faces.astype(np.int32)
    across, along = random.integers(2, 14, 2)
    corner = np.arange(across * along).reshape(across, along)
    wrap = random.random(2) < 0.3
    rows = corner if wrap[0] else corner[:-1]
    right, up = np.roll(corner, -1, axis=0)[: len(rows)], np.roll(rows, -1, axis=1)
    both = np.roll(right, -1, axis=1)
    faces = np.stack([rows, right, both, rows, both, up], axis=-1)
    faces = (faces if wrap[1] else faces[:, :-1]).reshape(-1, 3)
    angle = 2 * np.pi * corner / corner.size
    positions = np.stack([np.cos(angle * along), np.sin(angle * along), angle], axis=-1)
    positions = positions.reshape(-1, 3) + random.normal(0, random.choice([0, 0.1, 1]), (1, 3))
    hits = random.random(len(faces)) < random.choice([0, 0.1])
    faces[hits] = faces[hits][:, [0, 2, 1]]
    moved = random.random(positions.shape) < random.choice([0, 0.05])
    positions[moved] = random.choice(palette, int(moved.sum()))
    return positions, faces.astype(np.int32)


def options(random: np.random.Generator) -> partuv_engine.Options:
    """Options, now and then beyond their range."""
    chosen = partuv_engine.Options()
    chosen.max_area_distortion = random.uniform(1.0, 3.0) if random.random() < 0.95 else 0.5
    chosen.min_angular = random.uniform(0, 0.99)
    chosen.resolution = int(random.integers(16, 4096)) if random.random() < 0.95 else 0
    chosen.gutter_texels = random.uniform(0, 16) if random.random() < 0.95 else -1.0
    chosen.denoise = random.choice([-1.0, 0.0, 0.5, 1.0])
    chosen.profile = partuv_engine.Profile[random.choice(["balanced", "conformal"])]
    chosen.flattening = partuv_engine.Flattener[random.choice(["abf", "lscm"])]
    return chosen


@atheris.instrument_func
def one_input(data: bytes) -> None:
    """Unwrap one mesh and look at every corner."""
    random = np.random.default_rng(list(data))
    positions, faces = mesh(random)
    context = partuv_engine.Context(threads=1, deadline_s=DEADLINE_S)
    try:
        atlas = partuv_engine.unwrap(positions, faces, options(random), context)
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
