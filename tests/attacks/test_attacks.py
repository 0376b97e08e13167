"""Nothing from hostile files: a clear refusal, soon, in little memory, and no look outside."""

import sys
import time
import tracemalloc

import pytest
from partuv_contract.errors import InputError
from partuv_worker.glb.scene import Scene

from tests.attacks.hostile import ATTACKS

MEMORY_BYTES = 400 << 20
PROCESSOR_TIME_S = 4.0
OUTSIDE = ("open", "socket.connect", "socket.getaddrinfo", "subprocess.Popen", "os.system")

_watched: list[str] | None = None


def _watch(event, arguments):
    if _watched is not None and event in OUTSIDE:
        _watched.append(f"{event} {arguments[:1]}")


sys.addaudithook(_watch)


@pytest.fixture
def outside():
    """Names of the files, hosts and programs that were asked for during the test."""
    global _watched
    _watched = []
    yield _watched
    _watched = None


def peak_memory(data):
    """The most bytes that are held while the file is read; measuring it takes time."""
    tracemalloc.start()
    try:
        with pytest.raises(InputError):
            Scene(data)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", ATTACKS)
def test_an_attack_is_refused_with_its_reason(name, outside):
    attack = ATTACKS[name]
    assert attack.tries
    data = attack.build()
    outside.clear()
    started = time.thread_time()
    with pytest.raises(InputError) as caught:
        Scene(data)
    spent_s = time.thread_time() - started
    peak_bytes = peak_memory(data)
    assert type(caught.value) is attack.error, caught.value
    assert caught.value.message
    assert outside == []
    assert peak_bytes < MEMORY_BYTES
    assert spent_s < PROCESSOR_TIME_S


def test_an_image_elsewhere_is_neither_fetched_nor_a_reason_to_refuse(outside):
    from tests.support.glb_builder import tetrahedron
    from tests.support.uv import separate_faces

    builder = tetrahedron()
    builder.json["images"] = [{"uri": "http://127.0.0.1:9/x.png"}, {"uri": "../../etc/passwd"}]
    data = builder.build()
    outside.clear()
    scene = Scene(data)
    scene.write(separate_faces(len(scene.soup.faces)))
    assert outside == []
