"""Parts of the gateway that need nothing else."""

import hashlib
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from partuv_contract.service_errors import RangeError, UnauthorizedError
from partuv_service.callers import ANONYMOUS, ApiKeys, new_key
from partuv_service.jobs.ids import is_job_id, new_job_id
from partuv_service.routes.order import wait_s
from partuv_service.routes.results import _span
from partuv_service.settings import Settings
from pydantic import ValidationError


def test_job_ids_sort_by_time_and_are_valid() -> None:
    ids = []
    for _ in range(3):
        ids.append(new_job_id())
        time.sleep(0.002)
    assert ids == sorted(ids)
    assert all(is_job_id(one) for one in ids)
    version, variant = ids[0][4 + 12], int(ids[0][4 + 16], 16) >> 2
    assert (version, variant) == ("7", 0b10)
    assert len({new_job_id() for _ in range(10_000)}) == 10_000


@given(st.text())
def test_nothing_else_is_a_job_id(text: str) -> None:
    assert not is_job_id(text)
    assert not is_job_id(new_job_id() + text[:1] + "x")


def test_keys_are_known_by_their_digest() -> None:
    key, digest = new_key()
    assert digest == "sha256:" + hashlib.sha256(key.encode()).hexdigest()
    keys = ApiKeys({"anna": digest, "bert": new_key()[1].upper().replace("SHA256", "sha256")})
    assert keys.caller(f"Bearer {key}", None).id == "key:anna"
    assert keys.caller(f"bearer  {key} ", None).id == "key:anna"
    assert keys.caller(None, key).id == "key:anna"
    for authorization, api_key in [(None, None), ("Bearer ", None), (None, digest), (key, None)]:
        with pytest.raises(UnauthorizedError):
            keys.caller(authorization, api_key)


def test_without_keys_everybody_is_the_same() -> None:
    assert ApiKeys({}).caller("Bearer anything", None) is ANONYMOUS


@given(st.integers(1, 1000), st.integers(0, 2000), st.integers(0, 2000))
def test_ranges_agree_with_slicing(size: int, first: int, last: int) -> None:
    content = bytes(number % 251 for number in range(size))
    span = _span(f"bytes={first}-{last}", size)
    if first > last and first < size:
        assert span is None
    elif first >= size:
        assert isinstance(span, RangeError)
    else:
        assert isinstance(span, tuple)
        assert content[span[0] : span[1] + 1] == content[first : last + 1]


@pytest.mark.parametrize(
    ("prefer", "seconds"),
    [
        (None, None),
        ("", None),
        ("wait=30", 30.0),
        ("respond-async, wait=10", 10.0),
        ('wait="5"', 5.0),
        ("wait = 7; foo=bar", 7.0),
        ("wait=99999", 60.0),
        ("wait=-1", None),
        ("wait=abc", None),
        ("wait", None),
    ],
)
def test_prefer_wait(prefer: str | None, seconds: float | None) -> None:
    assert wait_s(prefer) == seconds


def test_settings_refuse_an_open_door() -> None:
    with pytest.raises(ValidationError, match="without API keys"):
        Settings(host="0.0.0.0")
    with pytest.raises(ValidationError, match="without API keys"):
        Settings(host="example.org")
    assert Settings(host="0.0.0.0", open_access=True).open_access
    assert Settings(host="0.0.0.0", api_keys={"a": "0" * 64}).api_keys
    assert Settings(host="::1").on_loopback


def test_settings_hide_their_secrets() -> None:
    settings = Settings(redis_url="redis://:hunter2@host/0", webhook_secrets=["whsec_c2VjcmV0"])
    assert "hunter2" not in repr(settings)
    assert "c2VjcmV0" not in repr(settings)
