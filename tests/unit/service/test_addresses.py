import asyncio
from ipaddress import ip_network

import pytest
from partuv_contract.service_errors import WebhookRefusedError
from partuv_service.webhooks.addresses import parse_target, resolve


def permitted(url: str, *networks: str) -> bool:
    allowed = [ip_network(network) for network in networks]
    try:
        return asyncio.run(resolve(parse_target(url), allowed)) is not None
    except WebhookRefusedError:
        return False


@pytest.mark.parametrize(
    "host",
    [
        "127.0.0.1",
        "127.1",
        "2130706433",
        "0x7f000001",
        "localhost",
        "0.0.0.0",
        "10.0.0.1",
        "172.16.5.4",
        "192.168.1.1",
        "169.254.169.254",
        "100.64.0.1",
        "192.0.2.1",
        "198.18.0.1",
        "224.0.0.1",
        "240.0.0.1",
        "255.255.255.255",
        "[::1]",
        "[::]",
        "[fe80::1]",
        "[fc00::1]",
        "[::ffff:127.0.0.1]",
        "[::ffff:10.0.0.1]",
        "[2002:7f00:1::]",
        "[64:ff9b::7f00:1]",
        "[64:ff9b::a9fe:a9fe]",
        "[ff02::1]",
    ],
)
def test_addresses_inside_are_refused(host: str) -> None:
    assert not permitted(f"https://{host}/hook")


@pytest.mark.parametrize("host", ["8.8.8.8", "1.1.1.1", "[2606:4700:4700::1111]", "8.8.8.8:8443"])
def test_public_addresses_are_fine(host: str) -> None:
    assert permitted(f"https://{host}/hook")


def test_an_operator_may_open_a_network() -> None:
    assert permitted("https://10.1.2.3/", "10.1.0.0/16")
    assert permitted("https://[::ffff:10.1.2.3]/", "10.1.0.0/16")
    assert not permitted("https://10.2.2.3/", "10.1.0.0/16")
    assert permitted("https://127.0.0.1:8443/", "127.0.0.0/8")


def test_a_name_that_is_not_known_is_not_refused_yet() -> None:
    assert asyncio.run(resolve(parse_target("https://nobody.invalid/"), [])) is None


@pytest.mark.parametrize(
    "url",
    [
        "http://example.org/",
        "https:///path",
        "https://",
        "example.org",
        "ftp://example.org/",
        "https://user@example.org/",
        "https://user:secret@example.org/",
        "https://example.org:99999/",
        "https://example.org:x/",
        "https://[::1/",
        "https://example.org/\r\nX-Evil: 1",
        "https://exämple.org/",
        "https://example.org/" + "x" * 3000,
    ],
)
def test_what_is_no_plain_https_url_is_refused(url: str) -> None:
    with pytest.raises(WebhookRefusedError) as refusal:
        parse_target(url)
    assert refusal.value.pointer == "/webhook_url"
    assert "secret" not in str(refusal.value)
