"""The whole service: real Redis, real gateway, real worker, real meshes."""

from collections.abc import Iterator

import httpx
import pytest

from tests.support.service import FAST, Gateway, Process, Stack, wait_for_workers


@pytest.fixture(scope="session")
def service() -> Iterator[Stack]:
    """One gateway and one worker of two slots, for tests that break nothing."""
    stack = Stack(**FAST)
    stack.gateway()
    stack.worker(slots="2", threads_per_job="1")
    yield stack
    stack.close()


@pytest.fixture(scope="session")
def gateway(service: Stack) -> Gateway:
    gateway = service.processes[0]
    assert isinstance(gateway, Gateway)
    wait_for_workers(gateway, 1)
    return gateway


@pytest.fixture(scope="session")
def worker(service: Stack) -> Process:
    return service.processes[1]


@pytest.fixture
def http(gateway: Gateway) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=gateway.url, timeout=60.0) as http:
        yield http
