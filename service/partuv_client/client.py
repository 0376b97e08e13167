"""The client, waiting (`PartUV`) and on an event loop (`AsyncPartUV`)."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self, cast

import httpx
from partuv_contract.jobs import Job

from partuv_client import flows
from partuv_client.errors import ClientError
from partuv_client.flows import Answer, OnProgress, Pause, Request, Steps, Unwrapped, Unwrapping

Source = str | Path | bytes


def _arguments(url: str, api_key: str | None, timeout_s: float, verify: Any) -> dict[str, Any]:
    headers = {"Authorization": f"Bearer {api_key}"} if api_key else {}
    return {
        "base_url": url.rstrip("/"),
        "headers": headers,
        "timeout": httpx.Timeout(timeout_s),
        "verify": verify,
    }


def _sent(request: Request) -> dict[str, Any]:
    return {
        "method": request.method,
        "url": request.path,
        "headers": dict(request.headers),
        "params": dict(request.query),
        "content": request.content,
    }


def _answer(response: httpx.Response) -> Answer:
    return Answer(response.status_code, response.headers, response.content)


def _nothing(failure: httpx.TransportError) -> Answer:
    return Answer(0, {}, (str(failure) or type(failure).__name__).encode())


class PartUV:
    """A service at an address. Retries what is worth retrying; a repeated submit is one job."""

    def __init__(
        self,
        url: str,
        *,
        api_key: str | None = None,
        timeout_s: float = 60.0,
        retries: int = 6,
        verify: Any = True,
    ) -> None:
        self._retries = retries
        self._http = httpx.Client(**_arguments(url, api_key, timeout_s, verify))

    def unwrap(
        self,
        source: Source,
        *,
        on_progress: OnProgress | None = None,
        webhook_url: str | None = None,
        **options: Any,
    ) -> Unwrapped:
        """Unwrap a file or bytes and wait for the result; an interrupt cancels the job.

        Raises `JobFailedError`, `JobCanceledError`, `ProblemError` or `ServiceUnreachableError`.
        """
        unwrapping = Unwrapping(source, options, on_progress, webhook_url)
        try:
            return cast(Unwrapped, self._run(unwrapping.steps()))
        except (KeyboardInterrupt, SystemExit):
            if unwrapping.job is not None:
                with suppress(ClientError):
                    self.cancel(unwrapping.job.id)
            raise

    def submit(
        self,
        source: Source,
        options: Mapping[str, Any] | None = None,
        *,
        webhook_url: str | None = None,
        retention_s: int | None = None,
    ) -> Job:
        """Upload and return at once."""
        steps = flows.submit(
            source, options or {}, webhook_url=webhook_url, retention_s=retention_s
        )
        return cast(Job, self._run(steps))

    def job(self, job_id: str) -> Job:
        """The job as it is now."""
        return cast(Job, self._run(flows.look(job_id)))

    def wait(self, job: Job, on_progress: OnProgress | None = None) -> Job:
        """The job when it has succeeded; raises if it did not."""
        return cast(Job, self._run(flows.follow(job, on_progress)))

    def cancel(self, job_id: str) -> Job:
        """Stop the job."""
        return cast(Job, self._run(flows.cancel(job_id)))

    def delete(self, job_id: str) -> None:
        """Stop the job and forget everything about it."""
        self._run(flows.delete(job_id))

    def fetch(self, job: Job, file: str = "result") -> bytes:
        """A file of a finished job: `result`, `preview`, `atlas` or `parts`."""
        return cast(bytes, self._run(flows.fetch(job, file)))

    def close(self) -> None:
        self._http.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        failure: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.close()

    def _run(self, steps: Steps) -> Any:
        steps, answer = flows.patiently(steps, self._retries), None
        while True:
            try:
                step = steps.send(answer)
            except StopIteration as end:
                return end.value
            if isinstance(step, Pause):
                time.sleep(step.seconds)
                answer = None
                continue
            try:
                answer = _answer(self._http.request(**_sent(step)))
            except httpx.TransportError as failure:
                answer = _nothing(failure)


class AsyncPartUV:
    """`PartUV` for an event loop."""

    def __init__(
        self,
        url: str,
        *,
        api_key: str | None = None,
        timeout_s: float = 60.0,
        retries: int = 6,
        verify: Any = True,
    ) -> None:
        self._retries = retries
        self._http = httpx.AsyncClient(**_arguments(url, api_key, timeout_s, verify))

    async def unwrap(
        self,
        source: Source,
        *,
        on_progress: OnProgress | None = None,
        webhook_url: str | None = None,
        **options: Any,
    ) -> Unwrapped:
        """Unwrap a file or bytes and wait for the result; canceling the task cancels the job."""
        unwrapping = Unwrapping(source, options, on_progress, webhook_url)
        try:
            return cast(Unwrapped, await self._run(unwrapping.steps()))
        except asyncio.CancelledError:
            if unwrapping.job is not None:
                with suppress(ClientError):
                    await self.cancel(unwrapping.job.id)
            raise

    async def submit(
        self,
        source: Source,
        options: Mapping[str, Any] | None = None,
        *,
        webhook_url: str | None = None,
        retention_s: int | None = None,
    ) -> Job:
        """Upload and return at once."""
        steps = flows.submit(
            source, options or {}, webhook_url=webhook_url, retention_s=retention_s
        )
        return cast(Job, await self._run(steps))

    async def job(self, job_id: str) -> Job:
        """The job as it is now."""
        return cast(Job, await self._run(flows.look(job_id)))

    async def wait(self, job: Job, on_progress: OnProgress | None = None) -> Job:
        """The job when it has succeeded; raises if it did not."""
        return cast(Job, await self._run(flows.follow(job, on_progress)))

    async def cancel(self, job_id: str) -> Job:
        """Stop the job."""
        return cast(Job, await self._run(flows.cancel(job_id)))

    async def delete(self, job_id: str) -> None:
        """Stop the job and forget everything about it."""
        await self._run(flows.delete(job_id))

    async def fetch(self, job: Job, file: str = "result") -> bytes:
        """A file of a finished job: `result`, `preview`, `atlas` or `parts`."""
        return cast(bytes, await self._run(flows.fetch(job, file)))

    async def close(self) -> None:
        await self._http.aclose()

    async def __aenter__(self) -> Self:
        return self

    async def __aexit__(
        self,
        kind: type[BaseException] | None,
        failure: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        await self.close()

    async def _run(self, steps: Steps) -> Any:
        steps, answer = flows.patiently(steps, self._retries), None
        while True:
            try:
                step = steps.send(answer)
            except StopIteration as end:
                return end.value
            if isinstance(step, Pause):
                await asyncio.sleep(step.seconds)
                answer = None
                continue
            try:
                answer = _answer(await self._http.request(**_sent(step)))
            except httpx.TransportError as failure:
                answer = _nothing(failure)
