"""Reads multipart/form-data as it comes in: the file goes straight on, fields are kept.

Nothing is spooled to disk, and a file that is no GLB is refused after its first bytes.
"""

from __future__ import annotations

from collections.abc import AsyncIterator, Awaitable, Callable

from partuv_contract.service_errors import MalformedRequestError
from python_multipart.exceptions import FormParserError
from python_multipart.multipart import MultipartParser, parse_options_header

_MAX_FIELDS = 100
_MAX_FIELD_BYTES = 16 * 1024
_FILE = "file"


class FormReader:
    """One form: `file` holds the GLB, every other field is a parameter."""

    def __init__(self, content_type: str, file_sink: Callable[[bytes], Awaitable[None]]) -> None:
        _, options = parse_options_header(content_type)
        boundary = options.get(b"boundary")
        if not boundary:
            raise MalformedRequestError("multipart/form-data without a boundary")
        self._sink = file_sink
        self._fields: list[tuple[str, bytearray]] = []
        self._has_file = False
        self._ended = False
        self._pending: list[bytes] = []
        self._header_name = b""
        self._header_value = b""
        self._disposition = b""
        self._part = ""
        self._parser = MultipartParser(
            boundary,
            {
                "on_part_begin": self._on_part_begin,
                "on_part_data": self._on_part_data,
                "on_header_field": self._on_header_field,
                "on_header_value": self._on_header_value,
                "on_header_end": self._on_header_end,
                "on_headers_finished": self._on_headers_finished,
                "on_end": self._on_end,
            },
        )

    async def read(self, body: AsyncIterator[bytes]) -> list[tuple[str, str]]:
        """Read all of it; the fields beside the file."""
        try:
            async for data in body:
                self._parser.write(data)
                for piece in self._pending:
                    await self._sink(piece)
                self._pending.clear()
            self._parser.finalize()
        except FormParserError as failure:
            raise MalformedRequestError(f"the form can't be read: {failure}") from failure
        if not self._ended:
            raise MalformedRequestError("the form breaks off")
        if not self._has_file:
            raise MalformedRequestError("the form has no field 'file'", pointer="/file")
        try:
            return [(name, value.decode()) for name, value in self._fields]
        except UnicodeDecodeError as failure:
            raise MalformedRequestError("a field of the form is not UTF-8") from failure

    def _on_part_begin(self) -> None:
        self._disposition = b""

    def _on_header_field(self, data: bytes, start: int, end: int) -> None:
        self._header_name += data[start:end]

    def _on_header_value(self, data: bytes, start: int, end: int) -> None:
        self._header_value += data[start:end]

    def _on_header_end(self) -> None:
        if self._header_name.lower() == b"content-disposition":
            self._disposition = self._header_value
        self._header_name = self._header_value = b""

    def _on_headers_finished(self) -> None:
        _, options = parse_options_header(self._disposition)
        self._part = options.get(b"name", b"").decode("utf-8", "replace")
        if self._part == _FILE:
            if self._has_file:
                raise MalformedRequestError("the form has more than one 'file'", pointer="/file")
            self._has_file = True
        elif not self._part:
            raise MalformedRequestError("a form field has no name")
        elif len(self._fields) >= _MAX_FIELDS:
            raise MalformedRequestError(f"the form has more than {_MAX_FIELDS} fields")
        else:
            self._fields.append((self._part, bytearray()))

    def _on_part_data(self, data: bytes, start: int, end: int) -> None:
        if self._part == _FILE:
            self._pending.append(data[start:end])
            return
        field = self._fields[-1][1]
        field += data[start:end]
        if len(field) > _MAX_FIELD_BYTES:
            raise MalformedRequestError(f"a form field has at most {_MAX_FIELD_BYTES} bytes")

    def _on_end(self) -> None:
        self._ended = True
