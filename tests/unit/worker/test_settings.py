import pytest
from partuv_worker.glb.limits import Limits
from partuv_worker.settings import WorkerSettings
from pydantic import ValidationError


def test_limits_of_uploads_are_settings(monkeypatch):
    assert WorkerSettings().limits == Limits()
    monkeypatch.setenv("PARTUV_LIMITS__FACES", "1000")
    assert WorkerSettings().limits == Limits(faces=1000)
    monkeypatch.setenv("PARTUV_LIMITS__WISHES", "3")
    with pytest.raises(ValidationError):
        WorkerSettings()
