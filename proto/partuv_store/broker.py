"""How gateway and workers meet in Celery: one task, one queue, messages that hold a job id only."""

from __future__ import annotations

from typing import Any

TASK = "partuv.unwrap"
QUEUE = "unwrap"
_KEY_PREFIX = "mq:"


def queue_key(prefix: str) -> str:
    """The Redis list in which messages wait, as Celery's transport names it."""
    return f"{prefix}{_KEY_PREFIX}{QUEUE}"


def celery_settings(redis_url: str, prefix: str, visibility_timeout_s: int) -> dict[str, Any]:
    """Settings both sides share; messages are wake-up calls, the job record is the truth.

    A message that comes twice (visibility timeout, lost connection) finds the job taken and is
    dropped; a message that is lost is published again by the gateway. So Celery keeps no results
    and retries nothing.
    """
    # Kombu names a unix socket its own way.
    url = redis_url.replace("unix://", "redis+socket://", 1)
    return {
        "broker_url": url,
        "broker_transport_options": {
            "global_keyprefix": f"{prefix}{_KEY_PREFIX}",
            "visibility_timeout": visibility_timeout_s,
            "socket_timeout": 30.0,
            "socket_connect_timeout": 5.0,
            "socket_keepalive": True,
            "retry_on_timeout": True,
            "health_check_interval": 25,
        },
        "broker_connection_retry_on_startup": True,
        "broker_connection_max_retries": None,
        "task_ignore_result": True,
        "task_store_errors_even_if_ignored": False,
        "task_default_queue": QUEUE,
        "task_serializer": "json",
        "accept_content": ["json"],
        "result_accept_content": ["json"],
        "worker_hijack_root_logger": False,
        "enable_utc": True,
    }
