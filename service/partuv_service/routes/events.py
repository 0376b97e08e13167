"""Follow a job: server-sent events."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from typing import Annotated, Any

from fastapi import APIRouter, Header
from fastapi.responses import StreamingResponse
from partuv_store import JobRecord

from partuv_service.deps import CallerDep, DeskDep
from partuv_service.jobs.view import to_json
from partuv_service.problems import OF_A_JOB, responses
from partuv_service.routes.jobs import JobId

router = APIRouter(prefix="/v1/jobs", tags=["jobs"])
_HEARTBEAT_S = 15.0
# Before OpenAPI 3.2 the schema of a stream of events is read as that of each event.
_EVENT = {
    "type": "object",
    "required": ["id", "event", "data"],
    "properties": {
        "id": {"type": "string"},
        "event": {"enum": ["status", "progress", "done"]},
        "data": {
            "type": "string",
            "contentMediaType": "application/json",
            "contentSchema": {"$ref": "#/components/schemas/Job"},
        },
    },
}
_EVENTS: dict[int | str, dict[str, Any]] = {
    200: {
        "description": (
            "Events `status` (the job's status changed), `progress` (its stage or progress did) "
            "and `done` (it has ended; the last event). The data of each is the job. A comment "
            "line comes every 15 s of silence. Send the last id back as `Last-Event-ID` to go on."
        ),
        "content": {"text/event-stream": {"schema": _EVENT}},
    },
    **responses(*OF_A_JOB),
}


@router.get("/{job_id}/events", operation_id="watchJob", response_model=None, responses=_EVENTS)
async def watch_job(
    job_id: JobId,
    caller: CallerDep,
    desk: DeskDep,
    last_event_id: Annotated[str | None, Header(description="Id of the last event seen")] = None,
) -> StreamingResponse:
    """The job's changes as they happen."""
    await desk.view(caller, job_id)
    seen = last_event_id or ""
    after = int(seen) if re.fullmatch(r"[0-9]{1,15}", seen) else -1
    records = desk.watch(caller, job_id, silence_s=_HEARTBEAT_S, after=after)
    return StreamingResponse(
        _events(records),
        media_type="text/event-stream",
        headers={"Cache-Control": "no-store", "X-Accel-Buffering": "no"},
    )


async def _events(records: AsyncIterator[JobRecord | None]) -> AsyncIterator[bytes]:
    yield b"retry: 1000\n\n"
    status = None
    async for record in records:
        if record is None:
            yield b": still here\n\n"
            continue
        if record.status.final:
            name = b"done"
        else:
            name = b"progress" if record.status is status else b"status"
        status = record.status
        yield b"id: %d\nevent: %s\ndata: %s\n\n" % (record.revision, name, to_json(record))
