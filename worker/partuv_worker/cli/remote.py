"""`partuv unwrap --server`: the same for the user, done by a service."""

from __future__ import annotations

import os
import threading
from typing import TYPE_CHECKING, NamedTuple

from partuv_contract.errors import CancelledError, ComponentMissingError, PartuvError
from partuv_contract.options import UnwrapOptions
from partuv_contract.problem import Problem, error_kinds
from partuv_contract.report import UnwrapReport
from partuv_contract.service_errors import UnavailableError

from partuv_worker.progress import Progress

if TYPE_CHECKING:
    from partuv_client import PartUV
    from partuv_contract.jobs import Job

API_KEY = "PARTUV_API_KEY"  # in the environment: arguments can be seen by everybody


class RemoteResult(NamedTuple):
    """What the service made."""

    glb: bytes
    report: UnwrapReport
    preview: bytes
    parts: bytes

    def preview_png(self) -> bytes:
        """The atlas as a picture."""
        return self.preview

    def parts_glb(self) -> bytes:
        """The surface coloured by part; the service makes it when parts were asked for."""
        return self.parts


class RemoteUnwrap:
    """One run by a service; progress and cancel may be called from any thread."""

    def __init__(self, url: str, options: UnwrapOptions) -> None:
        self._url = url
        self._options = options.model_dump(mode="json", exclude_unset=True)
        self._canceled = threading.Event()
        self.progress = Progress(0.0, "uploading")

    def cancel(self) -> None:
        """Stop the job there; heard when the service is asked next."""
        self._canceled.set()

    def run(self, data: bytes) -> RemoteResult:
        """Submit, follow, fetch. Raises the error that a local run would raise."""
        try:
            from partuv_client import ClientError, JobCanceledError, PartUV, ProblemError
        except ImportError as failure:
            raise ComponentMissingError(
                f"--server needs the client ({failure}); try: pip install 'partuv-service[client]'"
            ) from failure
        try:
            with PartUV(self._url, api_key=os.environ.get(API_KEY)) as client:
                return self._run(client, data)
        except JobCanceledError as failure:
            raise CancelledError(str(failure)) from failure
        except ProblemError as failure:
            raise _told_here(failure.problem) from failure
        except ClientError as failure:
            raise UnavailableError(f"no service at {self._url}: {failure}") from failure

    def _run(self, client: PartUV, data: bytes) -> RemoteResult:
        def heard(job: Job) -> None:
            self.progress = Progress(job.progress, job.stage or job.status.value)
            if self._canceled.is_set() and not job.status.final:
                client.cancel(job.id)
                raise CancelledError("interrupted")

        unwrapped = client.unwrap(data, on_progress=heard, **self._options)
        job = unwrapped.job
        return RemoteResult(
            unwrapped.glb,
            UnwrapReport(**(job.report or {})),
            client.fetch(job, "preview"),
            client.fetch(job, "parts") if job.links.parts else b"",
        )


def _told_here(problem: Problem) -> PartuvError:
    """The service's problem as the exception that it is on this side."""
    kind = error_kinds().get(problem.code, PartuvError)
    return kind(problem.detail)
