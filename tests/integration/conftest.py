"""A real Redis for the tests of the store, emptied before each."""

import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest
import redis
from partuv_service.serve.redis_server import RedisServer
from partuv_store import Store


@pytest.fixture(scope="session")
def redis_server() -> Iterator[RedisServer]:
    with tempfile.TemporaryDirectory(prefix="partuv-") as folder:
        server = RedisServer(Path(folder), Path(folder) / "redis.sock")
        server.start()
        yield server
        server.stop()


@pytest.fixture
def raw(redis_server: RedisServer) -> Iterator[redis.Redis]:
    client = redis.Redis.from_url(redis_server.url)
    client.flushall()
    yield client
    client.close()


@pytest.fixture
def store(redis_server: RedisServer, raw: redis.Redis) -> Iterator[Store]:
    store = Store(redis_server.url)
    yield store
    store.close()
