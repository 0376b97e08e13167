"""Delivers one webhook: signed as Standard Webhooks asks, to a pinned address, once.

See https://www.standardwebhooks.com: every configured secret signs, so that receivers can rotate
theirs; the id of the message is the job's, so that a repeated delivery is recognised.
"""

from __future__ import annotations

import json
import logging
import ssl
from collections.abc import Sequence
from datetime import UTC, datetime
from typing import Any

import httpx
from partuv_contract.jobs import Job, WebhookDelivery
from partuv_contract.service_errors import WebhookRefusedError
from pydantic import SecretStr
from standardwebhooks import Webhook

from partuv_service.webhooks.addresses import Network, parse_target, resolve

_log = logging.getLogger(__name__)
_TIMEOUT_S = 10.0


class WebhookSender:
    """Sends job endings to receivers."""

    def __init__(
        self,
        secrets: Sequence[SecretStr],
        networks: Sequence[Network],
        ca_file: str | None,
        user_agent: str,
    ) -> None:
        self._signers = [Webhook(secret.get_secret_value()) for secret in secrets]
        self._networks = networks
        # No proxy from the environment: the address that was checked is the one that is called.
        self._client = httpx.AsyncClient(
            verify=ssl.create_default_context(cafile=ca_file),
            timeout=_TIMEOUT_S,
            follow_redirects=False,
            trust_env=False,
            headers={"User-Agent": user_agent},
        )

    async def deliver(self, url: str, job: Job, attempt: int) -> WebhookDelivery:
        """Try once, and tell how it went."""
        at = datetime.now(UTC)
        try:
            status = await self._post(url, job, at)
        except (WebhookRefusedError, httpx.HTTPError, OSError, ValueError) as failure:
            reason = str(failure) or type(failure).__name__
            _log.info("webhook failed", extra={"attempt": attempt, "error": reason})
            return WebhookDelivery(at=at, attempt=attempt, error=reason, delivered=False)
        return WebhookDelivery(at=at, attempt=attempt, status=status, delivered=200 <= status < 300)

    async def _post(self, url: str, job: Job, at: datetime) -> int:
        target = parse_target(url)
        address = await resolve(target, self._networks)
        if address is None:
            raise httpx.ConnectError(f"the name {target.host} is not known")
        host = f"[{address}]" if address.version == 6 else str(address)
        pinned = httpx.URL(url).copy_with(host=host)
        body = _payload(job, at)
        request = self._client.build_request(
            "POST",
            pinned,
            content=body,
            headers=self._headers(job.id, at, body) | {"Host": httpx.URL(url).netloc.decode()},
            extensions={"sni_hostname": target.host},
        )
        # The answer's status is all that counts; its body is never read.
        response = await self._client.send(request, stream=True)
        await response.aclose()
        return response.status_code

    def _headers(self, message_id: str, at: datetime, body: bytes) -> dict[str, str]:
        signatures = [signer.sign(message_id, at, body.decode()) for signer in self._signers]
        return {
            "Content-Type": "application/json",
            "webhook-id": message_id,
            "webhook-timestamp": str(int(at.timestamp())),
            "webhook-signature": " ".join(signatures),
        }

    async def close(self) -> None:
        await self._client.aclose()


def _payload(job: Job, at: datetime) -> bytes:
    message: dict[str, Any] = {
        "type": f"job.{job.status.value}",
        "timestamp": at.isoformat(),
        "data": job.model_dump(mode="json", exclude={"webhook_deliveries"}),
    }
    return json.dumps(message).encode()
