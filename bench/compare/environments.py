"""An environment of its own for every peer, made once and kept in the cache."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import venv
from pathlib import Path

from bench.compare.tools import Tool


class Unavailable(Exception):
    """A tool cannot be installed here; the message says why."""


class Environments:
    """Makes what is missing in its folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._refused: dict[str, Unavailable] = {}

    def python(self, tool: Tool) -> Path:
        """The interpreter that has the tool; raises `Unavailable`."""
        if tool.is_ours:
            return Path(sys.executable)
        if tool.packages in self._refused:
            raise self._refused[tool.packages]
        key = hashlib.sha256(tool.packages.encode()).hexdigest()[:8]
        home = self._folder / f"{tool.adapter.removesuffix('_tool')}-{key}"
        python = home / ("Scripts" if sys.platform == "win32" else "bin") / "python"
        finished = home / "finished"
        if finished.exists():
            return python
        print(f"installing {tool.packages}", flush=True)
        try:
            venv.create(home, with_pip=True, clear=True)
            if tool.bare:
                _install(python, "--no-deps", *tool.bare)
            _install(python, *tool.requirements)
        except Unavailable as why:
            self._refused[tool.packages] = why
            raise
        finished.touch()
        return python


def _install(python: Path, *arguments: str) -> None:
    command = [str(python), "-m", "pip", "install", "--quiet", *arguments]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    if run.returncode:
        errors = [line for line in run.stderr.splitlines() if line.startswith("ERROR")]
        raise Unavailable((errors or ["pip failed"])[-1])
