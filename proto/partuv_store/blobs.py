"""Large values: written chunk by chunk, weighed against the store's budget, read by number."""

from __future__ import annotations

from partuv_contract.service_errors import StoreFullError

from partuv_store.operation import Operation

CHUNK_BYTES = 512 * 1024
_UNFINISHED_TTL_S = 900


def upload_name(job_id: str) -> str:
    """The blob of a job's uploaded GLB."""
    return f"upload:{job_id}"


def part_name(job_id: str, attempt: int, kind: str) -> str:
    """The blob an attempt writes before it is known whether its result counts."""
    return f"part:{job_id}:{attempt}:{kind}"


def result_blob(result: str, kind: str) -> str:
    """A blob of a published result; kind is glb, png, svg or parts."""
    return f"result:{result}:{kind}"


def append(blob: str, index: int, chunk: bytes, *, budget_bytes: int = 0) -> Operation[None]:
    """Write chunk number `index`; raises `StoreFullError` past the budget (0: no budget)."""

    def stored(reply: int) -> None:
        if not reply:
            raise StoreFullError("the job store is full; try again when other jobs have expired")

    return Operation("append", (blob, index, chunk, budget_bytes, _UNFINISHED_TTL_S), stored)


def drop(*blobs: str) -> Operation[None]:
    """Forget blobs at once."""
    return Operation("drop", blobs, lambda _: None)
