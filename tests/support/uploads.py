"""Uploads for tests that look at the service, not at meshes: a valid container, all different."""

from __future__ import annotations

import itertools
import struct

import httpx

_numbers = itertools.count()
GLB = {"Content-Type": "model/gltf-binary"}


def some_glb(size: int = 0) -> bytes:
    """A container that no test has sent before; the JSON inside is of no interest here."""
    text = f'{{"asset":{{"version":"2.0"}},"extras":{next(_numbers)}}}'.encode()
    text += b" " * max(-len(text) % 4, size - 20 - len(text))
    text += b" " * (-len(text) % 4)
    total = 20 + len(text)
    return struct.pack("<4sIIII", b"glTF", 2, total, len(text), 0x4E4F534A) + text


def submit(http: httpx.Client, **more: object) -> str:
    """Submit something new; the job's id."""
    headers = GLB | dict(more.pop("headers", {}))  # type: ignore[call-overload]
    answer = http.post("/v1/unwrap", content=some_glb(), headers=headers, **more)  # type: ignore[arg-type]
    assert answer.status_code == 202, answer.text
    return str(answer.json()["id"])
