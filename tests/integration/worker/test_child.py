"""The process that reads hostile files keeps to the limits of its worker's settings."""

from partuv_contract.options import UnwrapOptions
from partuv_worker.glb.limits import Limits
from partuv_worker.run.child_process import ChildProcess
from partuv_worker.settings import WorkerSettings

from tests.support.glb_builder import tetrahedron


def outcome(limits):
    """The last word of a child about a tetrahedron."""
    child = ChildProcess(
        memory_bytes=0, limits=limits, environment=WorkerSettings().child_environment()
    )
    try:
        child.wait_ready()
        options = UnwrapOptions().model_dump(mode="json")
        child.start_job("job", options, 1, [tetrahedron().build()])
        while True:
            frame = child.receive(30)
            assert frame is not None
            if frame.kind in ("done", "failed"):
                return frame
    finally:
        child.end()


def test_limits_reach_the_child():
    assert outcome(Limits()).kind == "done"
    failed = outcome(Limits(faces=3))
    assert failed.kind == "failed"
    assert failed.header["problem"]["code"] == "limit_exceeded"
