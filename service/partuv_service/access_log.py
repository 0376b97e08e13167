"""One log line and one count per request, and an id that follows it through the queue."""

from __future__ import annotations

import logging
import re
import time
import uuid

from partuv_contract.logs import log_context
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from partuv_service.metrics import Metrics

_log = logging.getLogger("partuv_service.access")
_REQUEST_ID = re.compile(r"[A-Za-z0-9._-]{1,128}")
_QUIET = {"/healthz", "/readyz", "/metrics"}


class AccessLog:
    """ASGI middleware; takes a request id from the client or makes one, and echoes it."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        request_id = Headers(scope=scope).get("x-request-id", "")
        if not _REQUEST_ID.fullmatch(request_id):
            request_id = uuid.uuid4().hex
        scope.setdefault("state", {})["request_id"] = request_id
        started = time.perf_counter()
        status = 500

        async def send_and_note(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)["X-Request-ID"] = request_id
            await send(message)

        with log_context(request_id=request_id):
            try:
                await self._app(scope, receive, send_and_note)
            finally:
                self._note(scope, status, time.perf_counter() - started)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        # The template, never the path: ids and queries stay out of labels and lines.
        route = getattr(scope.get("route"), "path", "unknown")
        method = scope["method"]
        self._metrics.requests.labels(route, method, str(status)).inc()
        self._metrics.durations.labels(route, method).observe(seconds)
        level = logging.DEBUG if route in _QUIET else logging.INFO
        job_id = scope.get("path_params", {}).get("job_id")
        extra = {"method": method, "route": route, "status": status}
        extra |= {"duration_ms": round(seconds * 1000, 2)} | ({"job_id": job_id} if job_id else {})
        _log.log(level, "request", extra=extra)
