"""`partuv serve`: everything from one command, and nothing left of it afterwards."""

import json
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import httpx

from tests.support.follow import ended, submit
from tests.support.meshes import quick
from tests.support.service import clean_environment, free_port, until

PARTUV = [sys.executable, "-c", "import sys, partuv_contract.commands as c; sys.exit(c.main())"]


class Serving:
    def __init__(self, data: Path | str, *more: str, folder: Path | None = None) -> None:
        self.port = free_port()
        ports = ["--port", str(self.port), "--grpc-port", str(free_port())]
        self.process = subprocess.Popen(
            [*PARTUV, "serve", *ports, "--data", str(data), *more],
            env=clean_environment(),
            cwd=folder,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )
        self.url = f"http://127.0.0.1:{self.port}"

    def ready(self) -> httpx.Client:
        def answers() -> bool:
            assert self.process.poll() is None, self.output()
            try:
                return bool(httpx.get(f"{self.url}/readyz").json().get("workers"))
            except httpx.TransportError:
                return False

        until(answers, 120.0, every_s=0.2)
        return httpx.Client(base_url=self.url, timeout=60.0)

    def output(self) -> str:
        return self.process.communicate(timeout=60.0)[0]


def offspring(pid: int) -> list[int]:
    found = []
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit():
            try:
                parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            except OSError:
                continue
            if parent == pid:
                found += [int(entry.name), *offspring(int(entry.name))]
    return found


def gone(pid: int) -> bool:
    try:
        return "Z" in Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return True


def test_jobs_outlive_a_restart_and_nothing_else_does(tmp_path: Path) -> None:
    first = Serving(tmp_path / "data")
    http = first.ready()
    job_id = submit(http, quick(201))
    done = ended(http, job_id)
    assert done["status"] == "succeeded"
    glb = http.get(done["links"]["result"]).content
    http.close()
    family = offspring(first.process.pid)
    assert len(family) >= 4, "Redis, gateway, worker and its child"

    rival = Serving(tmp_path / "data")
    assert "used by another service" in rival.output()
    assert rival.process.returncode == 1

    os.killpg(first.process.pid, signal.SIGINT)  # as a terminal does
    output = first.output()
    assert first.process.returncode == 0, output
    assert "Traceback" not in output
    until(lambda: all(gone(pid) for pid in family), 10.0)

    second = Serving(tmp_path / "data")
    http = second.ready()
    again = http.get(f"/v1/jobs/{job_id}").json()
    assert again["status"] == "succeeded"
    assert http.get(again["links"]["result"]).content == glb
    http.close()
    family = offspring(second.process.pid)
    second.process.kill()
    second.output()
    until(lambda: all(gone(pid) for pid in family), 30.0)
    assert oct((tmp_path / "data" / "webhook_secret").stat().st_mode)[-3:] == "600"


def test_an_errand_from_the_command_line(tmp_path: Path) -> None:
    source, target = tmp_path / "in.glb", tmp_path / "out.glb"
    report, preview = tmp_path / "report.json", tmp_path / "atlas.png"
    source.write_bytes(quick(202))
    files = {"submit": source, "output": target, "report": report, "preview": preview}
    flags = [word for name, path in files.items() for word in (f"--{name}", str(path))]
    serving = Serving("data", *flags, "--stop", folder=tmp_path)
    output = serving.output()
    assert serving.process.returncode == 0, output
    assert target.read_bytes().startswith(b"glTF")
    assert json.loads(report.read_text())["faces"] > 100
    assert preview.read_bytes().startswith(b"\x89PNG")
    for word in ("POST", "succeeded", "GET", "charts"):
        assert word in output


def test_a_taken_port_is_told(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        command = [*PARTUV, "serve", "--port", port, "--data", str(tmp_path / "data")]
        run = subprocess.run(
            command, env=clean_environment(), capture_output=True, text=True, timeout=120.0
        )
    assert run.returncode == 1
    assert "in use" in run.stderr


def test_settings_that_make_no_sense_are_told(tmp_path: Path) -> None:
    command = [*PARTUV, "serve", "--host", "0.0.0.0", "--data", str(tmp_path / "data")]
    run = subprocess.run(command, env=clean_environment(), capture_output=True, text=True)
    assert run.returncode == 2
    assert "API keys" in run.stderr
