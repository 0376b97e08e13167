"""What the gateway and the workers have to be told alike: where their jobs lie, and the terms."""

from __future__ import annotations

from pathlib import Path

from pydantic import AliasChoices, Field, SecretStr
from pydantic_settings import BaseSettings, SettingsConfigDict

from partuv_store.store import DEFAULT_PREFIX

_SECRETS = Path("/run/secrets")


class StoreSettings(BaseSettings):
    """Every field is an environment variable with the prefix PARTUV_, or a file in /run/secrets."""

    model_config = SettingsConfigDict(
        env_prefix="PARTUV_",
        frozen=True,
        extra="ignore",
        secrets_dir=_SECRETS if _SECRETS.is_dir() else None,
    )

    redis_url: SecretStr = Field(
        default=SecretStr("redis://127.0.0.1:6379/0"),
        validation_alias=AliasChoices("PARTUV_REDIS_URL", "REDIS_URL", "redis_url"),
        description="job store and message broker",
    )
    key_prefix: str = Field(
        default=DEFAULT_PREFIX, description="what every key in Redis begins with"
    )
    lease_s: float = Field(
        default=15.0, gt=0, description="silence after which a worker counts as lost"
    )
    max_losses: int = Field(
        default=2, ge=1, description="lost workers after which a job fails as worker_lost"
    )
    visibility_timeout_s: int = Field(
        default=1800, ge=10, description="time after which the broker delivers a message again"
    )
    log_level: str = Field(default="INFO", description="least level that is logged")
