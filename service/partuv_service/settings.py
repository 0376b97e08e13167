"""The settings of the gateway: one frozen object, read from the environment once."""

from __future__ import annotations

from ipaddress import IPv4Network, IPv6Network, ip_address
from pathlib import Path
from typing import Self

from partuv_store import StoreSettings
from pydantic import Field, SecretStr, model_validator


class Settings(StoreSettings):
    """A gateway's own, after those that its workers share."""

    host: str = Field(default="127.0.0.1", description="address to listen on")
    port: int = Field(default=8080, ge=1, le=65535, description="port of the REST interface")
    grpc_port: int = Field(
        default=50051, ge=-1, le=65535, description="port of the gRPC interface; -1: none"
    )

    api_keys: dict[str, str] = Field(
        default_factory=dict,
        description="name of each API key with its SHA-256, as `partuv keys` prints them",
    )
    open_access: bool = Field(
        default=False, description="serve without API keys on an address others can reach"
    )
    rate_limit_per_minute: int = Field(
        default=0, ge=0, description="requests per minute and key; 0: no limit"
    )
    rate_limit_burst: int = Field(
        default=60, ge=1, description="requests of one key that may come at once"
    )
    max_jobs_per_key: int = Field(
        default=0, ge=0, description="unfinished jobs per key; 0: no limit"
    )

    max_upload_bytes: int = Field(
        default=256 * 2**20,
        ge=1024,
        description="largest upload",
        json_schema_extra={"unit": "bytes"},
    )
    upload_idle_timeout_s: float = Field(
        default=30.0, gt=0, description="longest silence in the middle of an upload"
    )
    max_queued_jobs: int = Field(default=1000, ge=0, description="jobs that may wait; 0: no limit")
    store_budget_bytes: int = Field(
        default=2 * 2**30, ge=0, description="uploads and results kept in Redis; 0: no limit"
    )
    retention_s: int = Field(
        default=86_400, ge=1, description="how long results are kept; a job may ask for less"
    )

    upkeep_interval_s: float = Field(
        default=1.0, gt=0, description="time between two looks after lost and expired jobs"
    )

    webhook_secrets: list[SecretStr] = Field(
        default_factory=list,
        description="whsec_… secrets that webhooks are signed with; none: webhooks are off",
    )
    webhook_networks: list[IPv4Network | IPv6Network] = Field(
        default_factory=list, description="private networks that webhooks may go to all the same"
    )
    webhook_ca_file: Path | None = Field(
        default=None, description="certificates to trust for webhooks instead of the system's"
    )
    webhook_retry_delays_s: list[float] = Field(
        default=[5, 30, 120, 600, 1800, 3600, 7200, 14400],
        description="waits before a webhook is tried again",
    )

    @model_validator(mode="after")
    def _keys_where_others_can_reach(self) -> Self:
        if not (self.api_keys or self.open_access or self.on_loopback):
            raise ValueError(
                f"refusing to serve on {self.host} without API keys: set PARTUV_API_KEYS "
                "(see `partuv keys`) or PARTUV_OPEN_ACCESS=true"
            )
        return self

    @property
    def on_loopback(self) -> bool:
        """True if only this machine can reach the service."""
        try:
            return ip_address(self.host).is_loopback
        except ValueError:
            return self.host == "localhost"
