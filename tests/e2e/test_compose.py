"""What docker/compose.yaml starts, with its commands, settings and secrets, without containers."""

import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import httpx
import pytest
import redis
import yaml
from partuv_service.serve.redis_server import find_binary
from partuv_service.settings import Settings
from partuv_worker.settings import WorkerSettings

from tests.support.follow import ended, submit
from tests.support.meshes import quick
from tests.support.service import Gateway, Process, free_port, until, wait_for_workers

DOCKER = Path(__file__).resolve().parents[2] / "docker"
COMPOSE: dict[str, Any] = yaml.safe_load((DOCKER / "compose.yaml").read_text())
SETTINGS: dict[str, Any] = {"gateway": Settings, "worker": WorkerSettings}


class Secrets:
    """Made by docker/secrets.sh; seen by each service under the names that compose gives them."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        script = ["sh", str(DOCKER / "secrets.sh"), str(folder)]
        made = subprocess.run(script, capture_output=True, text=True, check=True)
        self.api_key = made.stdout.split()[-1]

    def mounted(self, service: str, folder: Path) -> Path:
        folder.mkdir()
        for secret in COMPOSE["services"][service]["secrets"]:
            short = {"source": secret, "target": secret}
            names = short if isinstance(secret, str) else secret
            source = Path(COMPOSE["secrets"][names["source"]]["file"]).name
            (folder / names["target"]).write_text((self.folder / source).read_text())
        return folder


@pytest.fixture(scope="module")
def secrets(tmp_path_factory: pytest.TempPathFactory) -> Secrets:
    return Secrets(tmp_path_factory.mktemp("compose") / "secrets")


@pytest.fixture(scope="module")
def redis_port(secrets: Secrets, tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    """The Redis of compose.yaml, by its own command."""
    _, *options = COMPOSE["services"]["redis"]["command"]
    users = str(secrets.folder / "redis_users")
    options = [users if option == "/run/secrets/redis_users" else option for option in options]
    port, data = free_port(), tmp_path_factory.mktemp("data")
    place = ["--port", str(port), "--bind", "127.0.0.1", "--dir", str(data)]
    with (data / "log").open("wb") as log:
        server = subprocess.Popen([str(find_binary()), *options, *place], stdout=log, stderr=log)
    yield port
    server.terminate()
    server.wait()


@pytest.fixture(scope="module")
def urls(secrets: Secrets, redis_port: int) -> dict[str, str]:
    """How each service reaches Redis, under its own name."""
    urls = {
        name: (secrets.folder / f"{name}_redis_url")
        .read_text()
        .replace("@redis:6379/", f"@127.0.0.1:{redis_port}/")
        for name in SETTINGS
    }

    def answers() -> bool:
        with redis.Redis.from_url(urls["gateway"]) as raw:
            try:
                return bool(raw.ping())
            except redis.ConnectionError:
                return False

    until(answers)
    return urls


@pytest.mark.parametrize("service", SETTINGS)
def test_settings_and_secrets_are_read(service: str, secrets: Secrets, tmp_path: Path) -> None:
    kind = SETTINGS[service]
    given = COMPOSE["services"][service]["environment"]
    names = {name.removeprefix("PARTUV_").lower() for name in given}
    assert names <= kind.model_fields.keys()
    settings = kind(_secrets_dir=secrets.mounted(service, tmp_path / "run"))
    assert settings.redis_url.get_secret_value().startswith(f"redis://{service}:")
    if service == "gateway":
        assert settings.api_keys.keys() == {"default"}
        assert len(settings.webhook_secrets) == 1


def test_a_job_passes_through(secrets: Secrets, urls: dict[str, str], tmp_path: Path) -> None:
    services = COMPOSE["services"]
    env = {n: services[n]["environment"] | {"PARTUV_REDIS_URL": urls[n]} for n in SETTINGS}
    env["gateway"] |= {
        name.upper(): (secrets.folder / name).read_text()
        for name in ("partuv_api_keys", "partuv_webhook_secrets")
    }
    gateway = Gateway(env["gateway"], tmp_path / "gateway.log").wait()
    worker = Process("partuv_worker", env["worker"], tmp_path / "worker.log")
    wait_for_workers(gateway, 1)
    key = {"Authorization": f"Bearer {secrets.api_key}"}
    with httpx.Client(base_url=gateway.url, headers=key, timeout=60.0) as http:
        job = ended(http, submit(http, quick(301)))
        assert job["status"] == "succeeded", job["error"]
        assert http.get(job["links"]["result"]).content.startswith(b"glTF")
        assert httpx.get(f"{gateway.url}/v1/jobs/{job['id']}").status_code == 401
        assert http.delete(job["links"]["self"]).status_code == 204
    assert worker.stop() == 0
    assert gateway.stop() == 0
    logs = (tmp_path / "gateway.log").read_text() + (tmp_path / "worker.log").read_text()
    passwords = [url.split(":")[2].partition("@")[0] for url in urls.values()]
    assert not [secret for secret in (secrets.api_key, *passwords) if secret in logs]
    assert "NOPERM" not in logs


@pytest.mark.parametrize("command", ["FLUSHALL", "CONFIG GET *", "KEYS *", "SHUTDOWN", "GET other"])
def test_services_do_not_rule_redis(urls: dict[str, str], command: str) -> None:
    for url in urls.values():
        with redis.Redis.from_url(url) as raw, pytest.raises(redis.exceptions.NoPermissionError):
            raw.execute_command(*command.split())


def test_strangers_get_nothing_from_redis(urls: dict[str, str], redis_port: int) -> None:
    with (
        redis.Redis(port=redis_port) as raw,
        pytest.raises(redis.exceptions.AuthenticationError),
    ):
        raw.ping()
