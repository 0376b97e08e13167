"""A worker played by hand: what the store would see of one, step by step."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from partuv_contract.errors import MalformedGlbError
from partuv_contract.jobs import JobStatus
from partuv_contract.problem import Problem
from partuv_store import Store, blobs, execution

FILES = {
    "glb": b"glTF" + bytes(range(256)) * 4096,
    "png": b"\x89PNG picture",
    "svg": b"<svg/>",
    "parts": b"glTF in colours",
}
REPORT = {"faces": 12, "chart_count": 3, "packing_efficiency": 0.6, "seconds": {"search": 0.2}}


@dataclass
class HandWorker:
    """Takes jobs when the test says so."""

    store: Store
    name: str = "by-hand"

    def claim(self, job_id: str) -> int:
        record = self.store.run(execution.claim(job_id, self.name, 30.0))
        assert record is not None
        return record.attempt

    def beat(self, job_id: str, stage: str, progress: float) -> str:
        return self.store.run(execution.beat(job_id, 1, 30.0, stage, progress))

    def succeed(self, job_id: str, build: str = "") -> None:
        attempt = self.claim(job_id)
        fields = {"report": json.dumps(REPORT), "faces": "12"}
        for kind, content in FILES.items():
            name = blobs.part_name(job_id, attempt, kind)
            for index in range(-(-len(content) // blobs.CHUNK_BYTES)):
                start = index * blobs.CHUNK_BYTES
                chunk = content[start : start + blobs.CHUNK_BYTES]
                self.store.run(blobs.append(name, index, chunk))
            fields[f"{kind}_bytes"] = str(len(content))
            fields[f"{kind}_sha256"] = hashlib.sha256(content).hexdigest()
        ending = execution.Ending(JobStatus.SUCCEEDED, fields=fields, build=build)
        assert self.store.run(execution.finish(job_id, attempt, ending))

    def fail(self, job_id: str) -> None:
        attempt = self.claim(job_id)
        problem = Problem.of(MalformedGlbError("accessor 0 is short", pointer="/accessors/0"))
        ending = execution.Ending(
            JobStatus.FAILED, problem.code, {"error": problem.model_dump_json()}
        )
        assert self.store.run(execution.finish(job_id, attempt, ending))
