"""Which files are read and written, and how: never half."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Job:
    """One file to unwrap and where its results go."""

    source: Path
    target: Path
    report: Path | None
    preview: Path | None
    parts: Path | None = None


def plan_jobs(
    source: Path,
    target: Path,
    report: Path | None,
    preview: Path | None,
    parts: Path | None = None,
) -> list[Job]:
    """One job for a file; one for each .glb below a folder, whose results are laid out alike."""
    if not source.is_dir():
        if target.is_dir():
            target = target / source.name
        return [Job(source, target, report, preview, parts)]
    found = sorted(path for path in source.rglob("*") if path.suffix.lower() == ".glb")
    written = [folder for folder in (target, parts) if folder is not None and folder != source]
    outside = [path for path in found if not any(map(path.is_relative_to, written))]
    return [
        Job(
            path,
            target / path.relative_to(source),
            _beside(report, path.relative_to(source), ".json"),
            _beside(preview, path.relative_to(source), ".png"),
            _beside(parts, path.relative_to(source), ".glb"),
        )
        for path in outside
    ]


def write_atomically(path: Path, content: bytes) -> None:
    """Write a file that is either complete or, if anything fails, not there."""
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        with open(part, "wb") as stream:
            stream.write(content)
            stream.flush()
            os.fsync(stream.fileno())
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def _beside(folder: Path | None, relative: Path, suffix: str) -> Path | None:
    return None if folder is None else folder / relative.with_suffix(suffix)
