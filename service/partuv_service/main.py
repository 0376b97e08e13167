"""The gateway: FastAPI and gRPC in one process, around one desk."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Iterable
from contextlib import asynccontextmanager
from importlib.metadata import version

import uvicorn
from fastapi import FastAPI
from partuv_store import AsyncStore

from partuv_service import openapi, problems
from partuv_service.access_log import AccessLog
from partuv_service.callers import ApiKeys
from partuv_service.deps import State
from partuv_service.housekeeper import Housekeeper
from partuv_service.jobs.desk import Desk
from partuv_service.jobs.hub import Hub
from partuv_service.jobs.publisher import Publisher
from partuv_service.metrics import Metrics
from partuv_service.routes import events, jobs, results, service, unwrap
from partuv_service.rpc.server import serving
from partuv_service.settings import Settings
from partuv_service.webhooks.sender import WebhookSender

_GOODBYE_S = 5
_CANCEL_AGAIN_S = 0.05


def create_app(settings: Settings) -> FastAPI:
    """The REST application; opens nothing until it is started."""
    metrics = Metrics()

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncIterator[None]:
        async with running(settings, metrics) as (state, hub):
            app.state.partuv, app.state.hub = state, hub
            if settings.grpc_port < 0:
                yield
                return
            async with serving(state):
                yield

    app = FastAPI(title="PartUV service", version=version("partuv-service"), lifespan=lifespan)
    app.add_middleware(AccessLog, metrics=metrics)
    for module in (unwrap, jobs, events, results, service):
        app.include_router(module.router)
    problems.install(app)
    openapi.complete(app)
    return app


@asynccontextmanager
async def running(settings: Settings, metrics: Metrics) -> AsyncIterator[tuple[State, Hub]]:
    """Everything behind the routes, from connections to the housekeeper."""
    url, prefix = settings.redis_url.get_secret_value(), settings.key_prefix
    store = AsyncStore(url, prefix=prefix)
    hub = Hub(store)
    publisher = Publisher(store, url, prefix, settings.visibility_timeout_s)
    desk = Desk(store, hub, publisher, settings)
    sender = _sender(settings)
    housekeeper = Housekeeper(store, publisher, sender, settings)
    tasks = [asyncio.create_task(work) for work in (hub.run(), *housekeeper.duties())]
    try:
        yield State(settings, store, desk, ApiKeys(settings.api_keys), metrics), hub
    finally:
        hub.close()
        await _end(tasks)
        if sender is not None:
            await sender.close()
        await publisher.close()
        await store.close()


async def _end(tasks: Iterable[asyncio.Task[None]]) -> None:
    """Cancel tasks until they have ended.

    Once is not enough on Python 3.11: `asyncio.wait_for`, through which redis sends, swallows the
    cancellation if what it waits for ends at that very moment (python/cpython#86296).
    """
    pending = set(tasks)
    while pending:
        for task in pending:
            task.cancel()
        _, pending = await asyncio.wait(pending, timeout=_CANCEL_AGAIN_S)


def _sender(settings: Settings) -> WebhookSender | None:
    if not settings.webhook_secrets:
        return None
    ca_file = str(settings.webhook_ca_file) if settings.webhook_ca_file else None
    agent = f"partuv-service/{version('partuv-service')}"
    return WebhookSender(settings.webhook_secrets, settings.webhook_networks, ca_file, agent)


class Gateway(uvicorn.Server):
    """Uvicorn that ends event streams before it waits for open connections."""

    def __init__(self, settings: Settings) -> None:
        self._app = create_app(settings)
        super().__init__(
            uvicorn.Config(
                self._app,
                host=settings.host,
                port=settings.port,
                log_config=None,
                access_log=False,
                server_header=False,
                timeout_graceful_shutdown=_GOODBYE_S,
            )
        )

    async def shutdown(self, sockets: list[object] | None = None) -> None:  # type: ignore[override]
        hub = getattr(self._app.state, "hub", None)
        if hub is not None:
            hub.close()
        await super().shutdown(sockets)  # type: ignore[arg-type]
