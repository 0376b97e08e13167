import asyncio
from collections.abc import AsyncIterator

import pytest
from hypothesis import given
from hypothesis import strategies as st
from partuv_contract.service_errors import MalformedRequestError
from partuv_service.routes.forms import FormReader

FIELDS = st.dictionaries(
    st.text("abcdefgh_", min_size=1, max_size=8), st.text(max_size=40), max_size=4
)


def encoded(file: bytes, fields: dict[str, str], boundary: bytes) -> bytes:
    parts = [(name.encode(), value.encode()) for name, value in fields.items()]
    parts.insert(len(parts) // 2, (b"file", file))
    body = b"".join(
        b'--%s\r\nContent-Disposition: form-data; name="%s"\r\n\r\n%s\r\n' % (boundary, *part)
        for part in parts
    )
    return body + b"--%s--\r\n" % boundary


@given(
    st.binary(max_size=300),
    FIELDS,
    st.lists(st.integers(1, 40), max_size=60),
)
def test_a_form_reads_the_same_however_it_is_cut(
    file: bytes, fields: dict[str, str], pieces: list[int]
) -> None:
    boundary = "a-boundary-that-no-file-has-7c1f"
    fields.pop("file", None)
    received = bytearray()

    async def sink(data: bytes) -> None:
        received.extend(data)

    body = encoded(file, fields, boundary.encode())

    async def stream() -> AsyncIterator[bytes]:
        start = 0
        for length in pieces:
            yield body[start : start + length]
            start += length
        yield body[start:]

    reader = FormReader(f"multipart/form-data; boundary={boundary}", sink)
    assert dict(asyncio.run(reader.read(stream()))) == fields
    assert bytes(received) == file


@given(st.binary(max_size=400))
def test_junk_is_refused_by_name(junk: bytes) -> None:
    async def sink(data: bytes) -> None:
        """Nothing to keep."""

    async def stream() -> AsyncIterator[bytes]:
        yield b"--X\r\n" + junk

    reader = FormReader("multipart/form-data; boundary=X", sink)
    with pytest.raises(MalformedRequestError):
        asyncio.run(reader.read(stream()))
