"""Cancelling, deadlines, progress and threads of a running unwrap."""

import threading
import time

import numpy as np
import pytest
from partuv_engine import Context, EngineError, Options, unwrap

from tests.support import shapes
from tests.support.atlas import assert_sound

STAGES = ["topology", "simplifying", "parts", "search", "flattening", "packing", "checking"]


@pytest.fixture(scope="module")
def rough():
    """A mesh that takes seconds."""
    return shapes.wavy(100, noise=0.35)


@pytest.fixture(scope="module")
def quick():
    return shapes.wavy(12)


class Running:
    """An unwrap on a thread of its own."""

    def __init__(self, mesh, context):
        self.context = context
        self.atlas = None
        self.error = None
        self.thread = threading.Thread(target=self._run, args=mesh)
        self.thread.start()

    def _run(self, positions, faces):
        try:
            self.atlas = unwrap(positions, faces, Options(), self.context)
        except EngineError as error:
            self.error = error

    def wait_for(self, stage):
        until = time.monotonic() + 60
        while self.thread.is_alive() and self.context.progress[1] != stage:
            assert time.monotonic() < until
            time.sleep(0.002)

    def join(self):
        self.thread.join(120)
        assert not self.thread.is_alive()


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("stage", ["simplifying", "search"])
def test_a_running_call_stops_soon_after_cancel(rough, stage, threads):
    running = Running(rough, Context(threads))
    running.wait_for(stage)
    # In seconds of processor time, so that what else runs on the machine does not count.
    start_s = time.process_time()
    running.context.cancel()
    running.join()
    assert time.process_time() - start_s < 0.2 * threads
    assert running.error is not None
    assert running.error.code == "cancelled"


def test_a_call_cancelled_before_it_starts_gives_nothing(quick):
    context = Context()
    context.cancel()
    assert context.cancelled
    with pytest.raises(EngineError, match="cancelled"):
        unwrap(*quick, Options(), context)


@pytest.mark.parametrize("deadline_s", [0.0, 0.3])
def test_a_deadline_leaves_a_complete_and_sound_atlas(rough, deadline_s):
    start_s = time.process_time()
    atlas = unwrap(*rough, Options(), Context(deadline_s=deadline_s))
    assert time.process_time() - start_s < deadline_s + 1.0
    assert_sound(*rough, atlas)


def test_a_generous_deadline_changes_nothing(quick):
    hurried = unwrap(*quick, Options(), Context(deadline_s=3600))
    np.testing.assert_array_equal(hurried.corner_uv, unwrap(*quick, Options(), Context()).corner_uv)


def test_progress_rises_through_the_stages():
    running = Running(shapes.wavy(40, noise=0.35), Context())
    seen = [running.context.progress]
    while running.thread.is_alive():
        seen.append(running.context.progress)
        time.sleep(0.001)
    running.join()
    seen.append(running.context.progress)
    fractions = np.array([fraction for fraction, _ in seen])
    assert (np.diff(fractions) >= 0).all()
    assert fractions[-1] == 1
    stages = list(dict.fromkeys(stage for _, stage in seen if stage))
    assert stages == [stage for stage in STAGES if stage in stages]
    assert {"search", "flattening"} <= set(stages)


def test_the_stages_are_timed(quick):
    atlas = unwrap(*quick, Options(), Context())
    names = [name for name, _ in atlas.stage_seconds]
    assert names == STAGES
    assert all(seconds >= 0 for _, seconds in atlas.stage_seconds)


def test_other_python_threads_run_meanwhile(rough):
    running = Running(rough, Context())
    running.wait_for("search")
    counted = 0
    until = time.monotonic() + 0.2
    while time.monotonic() < until:
        counted += 1
    alive = running.thread.is_alive()
    running.context.cancel()
    running.join()
    assert alive
    assert counted > 1000


def test_calls_on_two_threads_do_not_disturb_each_other():
    meshes = [shapes.wavy(24, seed=1, noise=0.2), shapes.torus(24, 12)]
    alone = [unwrap(*mesh, Options(), Context()).corner_uv for mesh in meshes]
    together = [Running(mesh, Context(threads=2)) for mesh in meshes * 2]
    for running in together:
        running.join()
    for running, expected in zip(together, alone * 2, strict=True):
        assert running.error is None
        np.testing.assert_array_equal(running.atlas.corner_uv, expected)


def test_a_context_tells_its_threads():
    assert Context(threads=3).threads == 3
    assert Context(threads=0).threads == 1
    assert Context().progress == (0.0, "")
