"""From the store's record of a job to the job that clients see."""

from __future__ import annotations

from partuv_contract.jobs import Job, JobInput, JobLinks, JobStatus
from partuv_store import JobRecord


def to_job(record: JobRecord) -> Job:
    """The job as it is told to its owner."""
    return Job.model_validate(
        {
            "id": record.id,
            "status": record.status,
            "stage": record.stage if record.status is JobStatus.RUNNING else None,
            "progress": record.progress,
            "created_at": record.time("created_at"),
            "started_at": record.time("started_at"),
            "finished_at": record.time("finished_at"),
            "expires_at": record.time("expires_at"),
            "queue_position": None if record.place is None else record.place + 1,
            "attempt": record.attempt,
            "cached": record.cached,
            "options": record.document("options"),
            "input": JobInput(
                sha256=record.input_sha256, bytes=record.input_bytes, faces=record.faces
            ),
            "report": record.document("report"),
            "error": record.document("error"),
            "webhook_deliveries": record.document("deliveries") or [],
            "links": _links(record),
        }
    )


def job_path(job_id: str) -> str:
    """The address of a job."""
    return f"/v1/jobs/{job_id}"


def to_json(record: JobRecord) -> bytes:
    """The job as JSON."""
    return to_job(record).model_dump_json().encode()


def _links(record: JobRecord) -> JobLinks:
    here = job_path(record.id)
    return JobLinks(
        self=here,
        cancel=f"{here}/cancel",
        events=f"{here}/events",
        result=f"{here}/result" if record.size("glb") is not None else None,
        preview=f"{here}/preview.png" if record.size("png") is not None else None,
        atlas=f"{here}/atlas.svg" if record.size("svg") is not None else None,
        parts=f"{here}/parts.glb" if record.size("parts") is not None else None,
    )
