"""What may be loaded where."""

import subprocess
import sys

import pytest

HEAVY = ("torch", "numpy", "PIL", "partuv_engine", "DracoPy")


@pytest.mark.parametrize(
    ("module", "banned"),
    [
        ("partuv_worker.app", HEAVY),
        ("partuv_worker.command", HEAVY),
        ("partuv_service.main", (*HEAVY, "partuv_worker")),
        ("partuv_service.serve.command", (*HEAVY, "partuv_worker")),
        ("partuv_client", (*HEAVY, "partuv_worker", "partuv_service", "redis", "celery", "grpc")),
        ("partuv_contract.jobs", (*HEAVY, "redis", "celery", "grpc", "fastapi", "httpx")),
    ],
)
def test_nothing_heavy_is_imported(module: str, banned: tuple[str, ...]) -> None:
    code = f"import sys, {module}; print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {name.partition(".")[0] for name in loaded} & set(banned)


def test_importing_opens_nothing() -> None:
    code = (
        "import sys\n"
        "sys.addaudithook(lambda event, _: sys.exit(9) if event == 'socket.connect' else None)\n"
        "import partuv_service.main, partuv_worker.command\n"
        "from partuv_worker.app import create_app\n"
        "from partuv_worker.settings import WorkerSettings\n"
        "create_app(WorkerSettings())\n"
        "from partuv_service.settings import Settings\n"
        "partuv_service.main.create_app(Settings())\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True)
