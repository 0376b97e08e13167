"""What holds for the atlas of any mesh, on random ones."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from partuv_engine import Context, EngineError, Flattener, Options, Profile, unwrap

from tests.support import shapes
from tests.support.atlas import assert_sound, valid_faces

quickly = settings(
    max_examples=40,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)

BASES = {
    "sheet": lambda side: shapes.wavy(side),
    "sphere": lambda side: shapes.icosphere(1 + (side > 4)),
    "torus": lambda side: shapes.torus(2 * side + 3, side + 3),
    "strip": lambda side: shapes.moebius(3 * side + 3, 2),
    "block": lambda side: shapes.cube(1 + side // 3),
    "cylinder": lambda side: shapes.cylinder(2 * side + 3, side),
}


@st.composite
def damaged_shapes(draw):
    """A shape with noise, some faces gone, doubled, turned over or without area."""
    base, side = draw(st.sampled_from(sorted(BASES))), draw(st.integers(1, 8))
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    positions, faces = BASES[base](side)
    noise = draw(st.sampled_from([0.0, 0.0, 0.02, 0.3]))
    positions = positions + noise / side * random.normal(size=positions.shape)
    faces = faces[random.random(len(faces)) >= draw(st.sampled_from([0.0, 0.0, 0.1, 0.6]))]
    hit = random.random((3, len(faces))) < draw(st.sampled_from([0.0, 0.0, 0.03]))
    faces[hit[0]] = faces[hit[0]][:, ::-1]
    faces[hit[1], 2] = faces[hit[1], 1]
    faces = np.concatenate([faces, faces[hit[2]]])
    if draw(st.booleans()):
        positions = np.round(positions, 2)  # welds some, flattens some
    return positions, faces.astype(np.int32)


@st.composite
def soups(draw):
    """Faces between random points: no edge is manifold for long."""
    random = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(3, 40))
    positions = random.normal(size=(count, 3))
    if draw(st.booleans()):
        positions = np.round(positions)
    positions[:, 2] *= draw(st.sampled_from([1.0, 0.0, 1e-6]))
    return positions, random.integers(0, count, (draw(st.integers(1, 80)), 3), dtype=np.int32)


@st.composite
def chosen_options(draw):
    options = Options()
    options.max_area_distortion = draw(st.sampled_from([1.25, 1.25, 1.02, 3.0]))
    options.min_angular = draw(st.sampled_from([0.95, 0.95, 0.0, 0.999]))
    options.profile = draw(st.sampled_from([Profile.balanced, Profile.conformal]))
    options.flattening = draw(st.sampled_from([Flattener.abf, Flattener.lscm]))
    options.denoise = draw(st.sampled_from([-1.0, 0.0, 3.0]))
    options.resolution = draw(st.sampled_from([1024, 128]))
    options.gutter_texels = draw(st.sampled_from([4.0, 1.0]))
    options.effort = draw(st.sampled_from([0.0, 0.0, 0.2]))
    options.cut_below_efficiency = draw(st.sampled_from([0.47, 0.0, 0.9]))
    return options


def has_area(mesh):
    positions, faces = mesh
    return len(faces) > 0 and valid_faces(positions, faces).any()


def check(mesh, options):
    if not has_area(mesh):
        with pytest.raises(EngineError, match=r"no_face_with_area|empty_mesh"):
            unwrap(*mesh, options, Context())
        return
    atlas = unwrap(*mesh, options, Context())
    assert_sound(
        *mesh,
        atlas,
        max_area_distortion=options.max_area_distortion,
        min_gutter_uv=options.gutter_texels / options.resolution,
    )


@quickly
@given(damaged_shapes(), chosen_options())
def test_damaged_shapes_get_a_sound_atlas(mesh, options):
    check(mesh, options)


@quickly
@given(soups(), chosen_options())
def test_soups_get_a_sound_atlas(mesh, options):
    check(mesh, options)


def quickly_packed():
    """Default options, but for a packing that takes a tenth of the time."""
    options = Options()
    options.effort = 0.1
    return options


@quickly
@given(damaged_shapes().filter(has_area))
def test_the_bytes_depend_on_the_mesh_alone(mesh):
    once = unwrap(*mesh, quickly_packed(), Context(threads=1))
    for threads in (1, 2):
        again = unwrap(*mesh, quickly_packed(), Context(threads=threads))
        assert once.corner_uv.tobytes() == again.corner_uv.tobytes()
        assert once.chart.tobytes() == again.chart.tobytes()
        assert once.part.tobytes() == again.part.tobytes()


@quickly
@given(
    st.integers(4, 14),
    st.integers(0, 2**32 - 1),
    st.sampled_from([1e-4, 1e4]),
    st.tuples(*[st.floats(-10, 10)] * 3),
)
def test_neither_size_nor_place_matters_much(side, seed, scale, shift):
    positions, faces = shapes.wavy(side, seed=seed, noise=0.2)
    here = len(unwrap(positions, faces, quickly_packed(), Context()).charts["faces"])
    moved = (positions + shift) * scale
    there = len(unwrap(moved, faces, quickly_packed(), Context()).charts["faces"])
    assert abs(here - there) <= max(1, 0.1 * here)
