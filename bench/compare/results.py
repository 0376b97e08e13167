"""What was measured so far: one JSON record per line, so that a run can be taken up again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

from bench.compare.judge import Figures

Status = Literal["ok", "failed", "timeout", "unavailable"]


@dataclass(frozen=True)
class Result:
    """One tool on one mesh. A later record of the same two replaces an earlier one."""

    mesh: str
    digest: str  # of the mesh file
    faces: int
    tool: str
    version: str
    status: Status
    limit_s: float
    seconds: float | None = None  # of the unwrapping itself, in a process of its own
    cpu_seconds: float | None = None  # the same on all processors together
    peak_rss_mb: float | None = None  # of that process, tool and interpreter included
    figures: Figures | None = None
    message: str = ""


class Results:
    """The records of one set of meshes."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._latest: dict[tuple[str, str], Result] = {}
        if path.exists():
            for line in path.read_text().splitlines():
                self._keep(_parsed(json.loads(line)))

    def __iter__(self) -> Iterator[Result]:
        return iter(self._latest.values())

    def is_done(self, mesh: str, digest: str, tool: str, version: str, limit_s: float) -> bool:
        """True if nothing has changed since; a time-out is tried again with more time."""
        known = self._latest.get((mesh, tool))
        return (
            known is not None
            and (known.digest, known.version) == (digest, version)
            and known.status != "unavailable"
            and not (known.status == "timeout" and known.limit_s < limit_s)
        )

    def add(self, result: Result) -> None:
        self._keep(result)
        self._path.parent.mkdir(parents=True, exist_ok=True)
        with self._path.open("a") as file:
            file.write(json.dumps(asdict(result)) + "\n")

    def _keep(self, result: Result) -> None:
        self._latest[result.mesh, result.tool] = result


def _parsed(record: dict[str, Any]) -> Result:
    figures = record.pop("figures")
    return Result(**record, figures=None if figures is None else Figures(**figures))
