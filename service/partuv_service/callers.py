"""Who calls: API keys, known by their SHA-256 only."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from dataclasses import dataclass

from partuv_contract.service_errors import UnauthorizedError

_PREFIX = "uv_live_"
_DIGEST_PREFIX = "sha256:"


@dataclass(frozen=True)
class Caller:
    """The owner of jobs."""

    id: str


ANONYMOUS = Caller("anonymous")


def new_key() -> tuple[str, str]:
    """A fresh API key and the digest to configure."""
    key = _PREFIX + secrets.token_urlsafe(32)
    return key, _digest(key)


class ApiKeys:
    """The configured keys; none configured means that everybody is `ANONYMOUS`."""

    def __init__(self, keys: dict[str, str]) -> None:
        self._digests = {
            f"key:{name}": digest.removeprefix(_DIGEST_PREFIX).lower()
            for name, digest in keys.items()
        }

    def caller(self, authorization: str | None, api_key: str | None) -> Caller:
        """Who sent `Authorization: Bearer …` or `X-API-Key`; raises `UnauthorizedError`."""
        if not self._digests:
            return ANONYMOUS
        scheme, _, token = (authorization or "").partition(" ")
        presented = token.strip() if scheme.lower() == "bearer" else api_key
        if not presented:
            raise UnauthorizedError("send an API key as 'Authorization: Bearer …' or 'X-API-Key'")
        digest = _digest(presented).removeprefix(_DIGEST_PREFIX)
        # Every digest is compared, in constant time: the duration tells nothing.
        found = [
            name for name, known in self._digests.items() if hmac.compare_digest(known, digest)
        ]
        if not found:
            raise UnauthorizedError("this API key is not known")
        return Caller(found[0])


def _digest(key: str) -> str:
    return _DIGEST_PREFIX + hashlib.sha256(key.encode("utf-8", "surrogateescape")).hexdigest()
