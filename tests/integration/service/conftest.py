"""A gateway on real ports with a real Redis; workers are played by hand."""

from collections.abc import Iterator

import httpx
import pytest
from partuv_store import Store

from tests.support.hand_worker import HandWorker
from tests.support.service import Gateway, Stack


@pytest.fixture(scope="session")
def stack() -> Iterator[Stack]:
    stack = Stack(log_level="DEBUG", upload_idle_timeout_s="2")
    yield stack
    stack.close()


@pytest.fixture(scope="session")
def gateway(stack: Stack) -> Gateway:
    return stack.gateway(max_upload_bytes="2000000")


@pytest.fixture
def http(gateway: Gateway) -> Iterator[httpx.Client]:
    with httpx.Client(base_url=gateway.url, timeout=20.0) as client:
        yield client


@pytest.fixture
def worker(stack: Stack) -> Iterator[HandWorker]:
    store = Store(stack.redis.url)
    yield HandWorker(store)
    store.close()
