"""The job as clients see it, in REST and (field by field the same) in gRPC."""

from __future__ import annotations

from datetime import datetime
from enum import StrEnum
from typing import Any

from pydantic import BaseModel, ConfigDict, Field

from partuv_contract.options import UnwrapOptions
from partuv_contract.problem import Problem


class JobStatus(StrEnum):
    """The state of a job; the last three are final and never change."""

    QUEUED = "queued"
    RUNNING = "running"
    SUCCEEDED = "succeeded"
    FAILED = "failed"
    CANCELED = "canceled"

    @property
    def final(self) -> bool:
        return self not in (JobStatus.QUEUED, JobStatus.RUNNING)


class JobInput(BaseModel):
    """The upload."""

    sha256: str = Field(description="Digest of the uploaded bytes, hexadecimal")
    bytes: int = Field(description="Size of the upload", ge=0)
    faces: int | None = Field(default=None, description="Triangles in it, once they are counted")


class JobLinks(BaseModel):
    """Addresses of the job; follow these instead of building your own."""

    self: str = Field(description="This job")
    cancel: str = Field(description="POST here to stop the job")
    events: str = Field(description="Server-sent events of the job")
    result: str | None = Field(default=None, description="The GLB, once the job succeeded")
    preview: str | None = Field(default=None, description="The atlas as PNG, if there is one")
    atlas: str | None = Field(default=None, description="The atlas as SVG, if there is one")
    parts: str | None = Field(
        default=None,
        description="The surface coloured by part, as GLB; for jobs with a number of parts or auto",
    )


class WebhookDelivery(BaseModel):
    """One try to tell the receiver that the job ended."""

    at: datetime = Field(description="When it was tried")
    attempt: int = Field(description="Number of the try, from 1", ge=1)
    status: int | None = Field(default=None, description="HTTP status of the receiver's answer")
    error: str | None = Field(default=None, description="Why there was no answer")
    delivered: bool = Field(description="True if the receiver took it")


class Job(BaseModel):
    """One unwrap, from its submission to its end."""

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "id": "job_019a3f2b7c5e7d0e9b4d2f8a6c1e3b57",
                    "status": "running",
                    "stage": "search",
                    "progress": 0.42,
                    "created_at": "2026-11-20T12:00:00Z",
                    "started_at": "2026-11-20T12:00:01Z",
                    "expires_at": "2026-11-21T12:00:00Z",
                    "attempt": 1,
                    "cached": False,
                    "options": {"resolution": 2048},
                    "input": {"sha256": "5d41…", "bytes": 482133},
                    "links": {
                        "self": "/v1/jobs/job_019a3f2b7c5e7d0e9b4d2f8a6c1e3b57",
                        "cancel": "/v1/jobs/job_019a3f2b7c5e7d0e9b4d2f8a6c1e3b57/cancel",
                        "events": "/v1/jobs/job_019a3f2b7c5e7d0e9b4d2f8a6c1e3b57/events",
                    },
                    "webhook_deliveries": [],
                }
            ]
        }
    )

    id: str = Field(description="Name of the job")
    status: JobStatus = Field(description="queued, running, succeeded, failed or canceled")
    stage: str | None = Field(default=None, description="What a running job is at")
    progress: float = Field(description="Share of the work done; never falls", ge=0.0, le=1.0)
    created_at: datetime = Field(description="When the job was accepted")
    started_at: datetime | None = Field(default=None, description="When a worker first took it")
    finished_at: datetime | None = Field(default=None, description="When it ended")
    expires_at: datetime = Field(description="When the job and its result are deleted")
    queue_position: int | None = Field(
        default=None, description="Jobs before this one plus one, while it is queued"
    )
    attempt: int = Field(description="Times a worker took the job", ge=0)
    cached: bool = Field(description="True if an earlier job had made this very result")
    options: UnwrapOptions = Field(description="All options, defaults filled in")
    input: JobInput
    report: dict[str, Any] | None = Field(
        default=None, description="What was measured on the result, once the job succeeded"
    )
    error: Problem | None = Field(default=None, description="Why a failed job failed")
    webhook_deliveries: list[WebhookDelivery] = Field(
        default_factory=list, description="Tries to call the webhook, oldest first"
    )
    links: JobLinks
