"""Where webhooks may go: public addresses over https, and networks the operator names."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Sequence
from dataclasses import dataclass
from ipaddress import IPv4Address, IPv4Network, IPv6Address, IPv6Network, ip_address
from urllib.parse import urlsplit

from partuv_contract.service_errors import WebhookRefusedError

Address = IPv4Address | IPv6Address
Network = IPv4Network | IPv6Network

MAX_URL_LENGTH = 2048
_RESOLVE_TIMEOUT_S = 5.0
_NAT64 = IPv6Network("64:ff9b::/96")


@dataclass(frozen=True)
class Target:
    """A webhook URL taken apart."""

    url: str
    host: str
    port: int


def parse_target(url: str) -> Target:
    """Take a webhook URL apart; raises `WebhookRefusedError` unless it is plain https."""
    try:
        parts = urlsplit(url)
        port = parts.port or 443
    except ValueError as failure:
        raise _refused(f"not a URL: {failure}") from failure
    if len(url) > MAX_URL_LENGTH or any(ord(letter) <= 32 or ord(letter) > 126 for letter in url):
        raise _refused(f"a webhook URL is ASCII without spaces, at most {MAX_URL_LENGTH} long")
    if parts.scheme != "https" or not parts.hostname:
        raise _refused("a webhook URL begins with https:// and names a host")
    if parts.username is not None or parts.password is not None:
        raise _refused("a webhook URL holds no user name or password")
    return Target(url, parts.hostname, port)


async def resolve(target: Target, allowed: Sequence[Network]) -> Address | None:
    """An address of the target, None where its name is not known (just now).

    Raises `WebhookRefusedError` if any address it has is not public: a name that points both out
    and in is an attack, not an accident.
    """
    loop = asyncio.get_running_loop()
    try:
        async with asyncio.timeout(_RESOLVE_TIMEOUT_S):
            found = await loop.getaddrinfo(target.host, target.port, type=socket.SOCK_STREAM)
    except (OSError, UnicodeError):
        return None
    addresses = [ip_address(str(entry[4][0]).partition("%")[0]) for entry in found]
    for address in addresses:
        if not _permitted(address, allowed):
            raise _refused(f"{target.host} is not a public address")
    return addresses[0] if addresses else None


def _permitted(address: Address, allowed: Sequence[Network]) -> bool:
    for inner in _addresses_inside(address):
        if any(inner.version == network.version and inner in network for network in allowed):
            continue
        if not inner.is_global or inner.is_multicast or inner.is_reserved:
            return False
    return True


def _addresses_inside(address: Address) -> list[Address]:
    """The address, or the IPv4 address that an IPv6 form of it leads to."""
    if isinstance(address, IPv6Address):
        if address.ipv4_mapped is not None:
            return [address.ipv4_mapped]
        if address.sixtofour is not None:
            return [address, address.sixtofour]
        if address in _NAT64:
            return [IPv4Address(int(address) & 0xFFFFFFFF)]
    return [address]


def _refused(reason: str) -> WebhookRefusedError:
    return WebhookRefusedError(reason, pointer="/webhook_url")
