"""The whole service: real Redis, real gateway, real worker, real meshes."""

from collections.abc import Iterator

import httpx
import pytest

from tests.support.service import Gateway, Process, Stack, until

FAST = {"lease_s": "6", "upkeep_interval_s": "0.3", "shutdown_grace_s": "0.5"}


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


def wait_for_workers(gateway: Gateway, count: int) -> None:
    def there() -> bool:
        answer = httpx.get(f"{gateway.url}/readyz")
        return answer.status_code == 200 and answer.json()["workers"] >= count

    until(there, 120.0, every_s=0.2)
