"""The job as the store keeps it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any

from partuv_contract.jobs import JobStatus


@dataclass(frozen=True)
class JobRecord:
    """One job. Times are UTC; `place` counts from 0 and is None unless the job is queued."""

    fields: dict[str, str]
    place: int | None = None

    @classmethod
    def from_reply(cls, flat: Sequence[bytes], place: int = -1) -> JobRecord:
        """From the flat list of names and values that HGETALL gives a script."""
        values = [value.decode() for value in flat]
        fields = dict(zip(values[::2], values[1::2], strict=True))
        return cls(fields, place if place >= 0 else None)

    @property
    def id(self) -> str:
        return self.fields["id"]

    @property
    def owner(self) -> str:
        return self.fields["owner"]

    @property
    def status(self) -> JobStatus:
        return JobStatus(self.fields["status"])

    @property
    def stage(self) -> str | None:
        return self.fields["stage"] or None

    @property
    def progress(self) -> float:
        return float(self.fields["progress"])

    @property
    def revision(self) -> int:
        """Grows with every change of the job."""
        return int(self.fields["revision"])

    @property
    def attempt(self) -> int:
        """Which try this is: the fencing token of a running job."""
        return int(self.fields["attempt"])

    @property
    def request_id(self) -> str:
        return self.fields["request_id"]

    @property
    def input_sha256(self) -> str:
        return self.fields["input_sha256"]

    @property
    def input_bytes(self) -> int:
        return int(self.fields["input_bytes"])

    @property
    def input_chunks(self) -> int:
        return int(self.fields["input_chunks"])

    @property
    def faces(self) -> int | None:
        return self._integer("faces")

    @property
    def cached(self) -> bool:
        return self.fields.get("cached") == "1"

    @property
    def result(self) -> str | None:
        """The name its result's blobs have, once it succeeded."""
        return self.fields.get("result")

    @property
    def webhook_url(self) -> str | None:
        return self.fields["webhook_url"] or None

    def size(self, kind: str) -> int | None:
        """Bytes of a result's blob, None where there is none."""
        return self._integer(f"{kind}_bytes")

    def sha256(self, kind: str) -> str:
        return self.fields[f"{kind}_sha256"]

    def time(self, name: str) -> datetime | None:
        """created_at, started_at, finished_at or expires_at."""
        value = self.fields.get(name)
        return datetime.fromtimestamp(int(value) / 1000, UTC) if value else None

    def document(self, name: str) -> Any:
        """A field that holds JSON: options, report, error or deliveries."""
        value = self.fields.get(name)
        return json.loads(value) if value else None

    def _integer(self, name: str) -> int | None:
        value = self.fields.get(name)
        return int(value) if value else None
