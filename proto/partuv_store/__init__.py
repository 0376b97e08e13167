"""The job store in Redis: what gateway and workers tell each other.

Every transition of a job is one Lua script (folder `scripts`), so it happens whole or not at all,
whoever dies in the middle. Needs nothing newer than Redis 6.2.
"""

from partuv_store.operation import Operation
from partuv_store.record import JobRecord
from partuv_store.settings import StoreSettings
from partuv_store.store import AsyncStore, Store

__all__ = ["AsyncStore", "JobRecord", "Operation", "Store", "StoreSettings"]
