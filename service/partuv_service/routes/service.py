"""About the service itself: options, probes, version, metrics."""

from __future__ import annotations

import platform
from importlib.metadata import version

from fastapi import APIRouter
from fastapi.responses import RedirectResponse, Response
from partuv_contract.option_table import OptionInfo, option_table
from partuv_contract.service_errors import StoreUnavailableError, UnavailableError
from partuv_store import upkeep
from prometheus_client import CONTENT_TYPE_LATEST
from pydantic import BaseModel, Field

from partuv_service.deps import StateDep
from partuv_service.problems import responses

router = APIRouter(tags=["service"])


class Health(BaseModel):
    """Alive."""

    status: str = Field(description="ok")


class Readiness(BaseModel):
    """Ready to take jobs."""

    status: str = Field(description="ok")
    workers: int = Field(description="Workers that are alive; jobs wait while there are none")
    queued: int = Field(description="Jobs that wait")
    running: int = Field(description="Jobs that run")


class Version(BaseModel):
    """What is running."""

    name: str
    version: str
    python: str
    workers: list[str] = Field(description="Builds of the workers that are alive")


@router.get("/", include_in_schema=False)
async def index() -> Response:
    """The documentation."""
    return RedirectResponse("/docs")


@router.get("/v1/options", operation_id="listOptions")
async def list_options() -> list[OptionInfo]:
    """Every option with its default, range, unit and meaning."""
    return option_table()


@router.get("/healthz", operation_id="getHealth")
async def health() -> Health:
    """Is the process alive?"""
    return Health(status="ok")


@router.get("/readyz", operation_id="getReadiness", responses=responses(StoreUnavailableError))
async def readiness(state: StateDep) -> Readiness:
    """Can it take jobs? Answers 503 while Redis is away."""
    survey = await state.store.run(upkeep.survey())
    return Readiness(
        status="ok", workers=len(survey.workers), queued=survey.waiting, running=survey.running
    )


@router.get("/version", operation_id="getVersion")
async def get_version(state: StateDep) -> Version:
    """What is running here."""
    try:
        workers = (await state.store.run(upkeep.survey())).workers
    except UnavailableError:
        workers = []
    builds = sorted({str(worker.get("build", "")) for worker in workers})
    return Version(
        name="partuv-service",
        version=version("partuv-service"),
        python=platform.python_version(),
        workers=builds,
    )


@router.get("/metrics", operation_id="getMetrics", response_class=Response)
async def metrics(state: StateDep) -> Response:
    """Prometheus metrics of this gateway and of all workers."""
    try:
        survey = await state.store.run(upkeep.survey())
    except UnavailableError:
        survey = None
    return Response(state.metrics.render(survey), media_type=CONTENT_TYPE_LATEST)
