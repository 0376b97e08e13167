"""Look at a job, stop it, forget it."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Path
from fastapi.responses import Response
from partuv_contract.jobs import Job
from partuv_store import JobRecord

from partuv_service.deps import CallerDep, DeskDep
from partuv_service.jobs.ids import PATTERN
from partuv_service.jobs.view import to_json
from partuv_service.problems import OF_A_JOB, responses

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])

# Not validated by FastAPI: what can't be a job's id is a job that isn't there (404, not 422).
JobId = Annotated[
    str, Path(description="The job's id", json_schema_extra={"pattern": PATTERN}, alias="job_id")
]
_JOB: dict[int | str, dict[str, Any]] = {
    200: {
        "model": Job,
        "description": "The job as it is now",
        "headers": {
            "Retry-After": {
                "description": "Seconds until it is worth asking again; missing once the job ended",
                "schema": {"type": "integer"},
            }
        },
    },
    **responses(*OF_A_JOB),
}


@router.get("/{job_id}", operation_id="getJob", response_model=None, responses=_JOB)
async def get_job(job_id: JobId, caller: CallerDep, desk: DeskDep) -> Response:
    """The job: its state, and its report or error once it has ended."""
    return job_response(await desk.view(caller, job_id))


@router.post("/{job_id}/cancel", operation_id="cancelJob", response_model=None, responses=_JOB)
async def cancel_job(job_id: JobId, caller: CallerDep, desk: DeskDep) -> Response:
    """Stop the job: at once if it waits, within a second or so if it runs. Asking twice is fine."""
    return job_response(await desk.cancel(caller, job_id))


@router.delete(
    "/{job_id}",
    operation_id="deleteJob",
    status_code=204,
    response_model=None,
    responses=responses(*OF_A_JOB),
)
async def delete_job(job_id: JobId, caller: CallerDep, desk: DeskDep) -> Response:
    """Stop the job and forget it: upload, result and report are gone at once."""
    await desk.forget(caller, job_id)
    return Response(status_code=204)


def job_response(record: JobRecord) -> Response:
    """The job as JSON, with a hint when to come back."""
    headers = {} if record.status.final else {"Retry-After": "1"}
    return Response(to_json(record), media_type="application/json", headers=headers)
