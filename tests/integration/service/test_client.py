"""The Python client, both kinds, against a real gateway."""

import asyncio
import socket
import threading
from contextlib import suppress
from pathlib import Path

import pytest
import redis
from partuv_client import (
    AsyncPartUV,
    JobCanceledError,
    JobFailedError,
    PartUV,
    ProblemError,
    ServiceUnreachableError,
)
from partuv_contract.errors import OptionError
from partuv_contract.jobs import Job, JobStatus

from tests.support.hand_worker import FILES, HandWorker
from tests.support.service import Gateway, Stack, free_port
from tests.support.uploads import some_glb


class Watcher:
    """Does something to the job as soon as the client heard of it."""

    def __init__(self, act) -> None:
        self._act = act
        self.seen: list[JobStatus] = []

    def __call__(self, job: Job) -> None:
        if not self.seen:
            threading.Thread(target=self._act, args=(job.id,)).start()
        self.seen.append(job.status)


def test_unwrap_saves_a_file(gateway: Gateway, worker: HandWorker, tmp_path: Path) -> None:
    source, target = tmp_path / "in.glb", tmp_path / "out.glb"
    source.write_bytes(some_glb(700_000))
    watcher = Watcher(worker.succeed)
    with PartUV(gateway.url) as client:
        result = client.unwrap(source, on_progress=watcher, resolution=2048, only=["a", "b"])
        result.save(target)
        assert client.fetch(result.job, "preview") == FILES["png"]
        assert client.fetch(result.job, "atlas") == FILES["svg"]
    assert target.read_bytes() == FILES["glb"]
    assert (result.job.options.resolution, result.job.options.only) == (2048, ("a", "b"))
    assert watcher.seen[0] is JobStatus.QUEUED
    assert watcher.seen[-1] is JobStatus.SUCCEEDED


def test_unwrap_on_an_event_loop(gateway: Gateway, worker: HandWorker) -> None:
    async def run() -> list[bytes]:
        async with AsyncPartUV(gateway.url) as client:
            jobs = [client.unwrap(some_glb(), on_progress=Watcher(worker.succeed)) for _ in "abc"]
            return [result.glb for result in await asyncio.gather(*jobs)]

    assert asyncio.run(run()) == [FILES["glb"]] * 3


def test_failures_say_why(gateway: Gateway, worker: HandWorker) -> None:
    with PartUV(gateway.url) as client:
        with pytest.raises(JobFailedError) as failed:
            client.unwrap(some_glb(), on_progress=Watcher(worker.fail))
        assert failed.value.problem.code == "malformed_glb"
        assert failed.value.job.status is JobStatus.FAILED
        with pytest.raises(JobCanceledError):
            client.unwrap(some_glb(), on_progress=lambda job: client.cancel(job.id))
        with pytest.raises(ProblemError) as refused:
            client.unwrap(b"no mesh")
        assert refused.value.problem.code == "not_glb"
        with pytest.raises(OptionError):
            client.unwrap(some_glb(), resolution=1)
        with pytest.raises(ProblemError) as unknown:
            client.job("job_" + "0" * 32)
        assert unknown.value.problem.code == "job_not_found"


def test_submit_look_cancel_delete(gateway: Gateway) -> None:
    with PartUV(gateway.url) as client:
        job = client.submit(some_glb(), {"gutter_texels": 2}, retention_s=60)
        assert client.job(job.id).status is JobStatus.QUEUED
        assert client.cancel(job.id).status is JobStatus.CANCELED
        client.delete(job.id)
        with pytest.raises(ProblemError):
            client.job(job.id)


def test_a_canceled_task_cancels_its_job(gateway: Gateway) -> None:
    async def run() -> JobStatus:
        accepted: asyncio.Future[Job] = asyncio.get_running_loop().create_future()

        def note(job: Job) -> None:
            if not accepted.done():
                accepted.set_result(job)

        async with AsyncPartUV(gateway.url) as client:
            task = asyncio.create_task(client.unwrap(some_glb(), on_progress=note))
            job = await accepted
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
            return (await client.job(job.id)).status

    assert asyncio.run(run()) is JobStatus.CANCELED


def test_nobody_there() -> None:
    client = PartUV(f"http://127.0.0.1:{free_port()}", retries=0)
    with pytest.raises(ServiceUnreachableError):
        client.job("job_" + "0" * 32)
    client.close()


def test_a_lost_answer_does_not_make_a_second_job(gateway: Gateway, stack: Stack) -> None:
    """A proxy that swallows the first answer: the client sends again, with the same key."""
    with redis.Redis.from_url(stack.redis.url) as raw:
        before = raw.zcard("partuv:waiting")
        proxy = SwallowingProxy(gateway.port)
        with PartUV(proxy.url) as client:
            job = client.submit(some_glb())
        assert proxy.swallowed == 1
        assert raw.zcard("partuv:waiting") == before + 1
    assert job.status is JobStatus.QUEUED
    proxy.close()


class SwallowingProxy:
    """Forwards connections to the gateway; drops the first one when the answer comes."""

    def __init__(self, port: int) -> None:
        self._port = port
        self.swallowed = 0
        self._server = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self._server.getsockname()[1]}"
        threading.Thread(target=self._accept, daemon=True).start()

    def close(self) -> None:
        self._server.close()

    def _accept(self) -> None:
        while True:
            try:
                client, _ = self._server.accept()
            except OSError:
                return
            threading.Thread(target=self._forward, args=(client,), daemon=True).start()

    def _forward(self, client: socket.socket) -> None:
        with client, socket.create_connection(("127.0.0.1", self._port)) as gateway:
            up = threading.Thread(target=_pump, args=(client, gateway), daemon=True)
            up.start()
            data = gateway.recv(65536)
            if not self.swallowed:
                self.swallowed = 1
                client.shutdown(socket.SHUT_RDWR)  # closing alone waits for the other thread
                return
            while data:
                client.sendall(data)
                data = gateway.recv(65536)


def _pump(source: socket.socket, target: socket.socket) -> None:
    with suppress(OSError):
        while data := source.recv(65536):
            target.sendall(data)
