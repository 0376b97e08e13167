"""Where `partuv serve` keeps what must outlast it."""

from __future__ import annotations

import base64
import fcntl
import os
import secrets
from pathlib import Path
from typing import IO


def default_folder() -> Path:
    """The user's own folder for this service."""
    base = os.environ.get("XDG_DATA_HOME") or Path.home() / ".local" / "share"
    return Path(base) / "partuv"


class DataFolder:
    """A folder that one service uses at a time: two on one append-only file would destroy it."""

    def __init__(self, path: Path) -> None:
        self.path = path
        path.mkdir(parents=True, exist_ok=True, mode=0o700)
        self._lock = (path / "lock").open("w")

    def lock(self) -> bool:
        """Take the folder; False if another service has it."""
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False
        return True

    @property
    def lock_descriptor(self) -> int:
        """To be inherited: the folder stays taken as long as one process holds it."""
        return self._lock.fileno()

    def open_log(self) -> IO[bytes]:
        """The log of this run; that of the run before is kept beside it."""
        log = self.path / "service.log"
        if log.exists():
            log.replace(log.with_suffix(".log.old"))
        return log.open("ab")

    def webhook_secret(self) -> str:
        """The secret that webhooks are signed with, made on first use."""
        place = self.path / "webhook_secret"
        if not place.exists():
            text = "whsec_" + base64.b64encode(secrets.token_bytes(32)).decode()
            descriptor = os.open(place, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(descriptor, "w") as stream:
                stream.write(text)
        return place.read_text().strip()
