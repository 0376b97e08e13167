"""Coverage-guided fuzzing of the reader and writer: `python -m tests.fuzz.fuzz_reader`.

Whatever bytes come, the reader either refuses them with an `InputError`, or the file can be written
with UVs and read again with the same triangles. Arguments are those of libFuzzer, such as
-max_total_time=60.
"""

from __future__ import annotations

import copy
import json
import sys
from typing import Any

import atheris

with atheris.instrument_imports(include=["partuv_worker.glb"]):
    import numpy as np
    from partuv_contract.errors import InputError
    from partuv_worker.glb.limits import Limits
    from partuv_worker.glb.scene import Scene

from tests.support.glb_builder import pack
from tests.support.uv import separate_faces
from tests.unit.worker.glb.test_decompress import draco_file, meshopt_file
from tests.unit.worker.glb.test_writing import rich_grid

LIMITS = Limits(
    file_bytes=1 << 20, nodes=1000, vertices=20_000, faces=20_000, decoded_bytes=1 << 24
)
BASES = [
    (
        builder.json
        | {"buffers": builder.json.get("buffers", [{"byteLength": len(builder.binary)}])},
        builder.binary,
    )
    for builder in (rich_grid(), draco_file(), meshopt_file())
]
VALUES: list[Any] = [
    0, 1, 2, 3, 4, 5, 6, 7, -1, 255, 256, 65535, 2**31, 2**32, 2**53, 2**64, 0.5, 1e308, True, None,
    "", "VEC3", "SCALAR", 5121, 5123, 5125, 5126, [], {}, [0], [0, 0], {"bufferView": 0},
]  # fmt: skip
MODES = ("keep", "append", "replace")
COMPRESSIONS = ("none", "meshopt", "draco")


def places(value: Any) -> list[tuple[Any, Any]]:
    """Every (container, key) below a JSON value."""
    keys = range(len(value)) if isinstance(value, list) else list(value)
    found = [(value, key) for key in keys]
    for container, key in list(found):
        if isinstance(container[key], list | dict):
            found += places(container[key])
    return found


def edited_file(provider: atheris.FuzzedDataProvider) -> bytes:
    """A good file with a few members changed, copied, swapped or removed."""
    document, binary = BASES[provider.ConsumeIntInRange(0, len(BASES) - 1)]
    document = copy.deepcopy(document)
    for _ in range(provider.ConsumeIntInRange(1, 4)):
        found = places(document)
        container, key = found[provider.ConsumeIntInRange(0, len(found) - 1)]
        action = provider.ConsumeIntInRange(0, 3)
        if action == 0:
            container[key] = VALUES[provider.ConsumeIntInRange(0, len(VALUES) - 1)]
        elif action == 1:
            container[key] = provider.ConsumeIntInRange(-4, 4000)
        elif action == 2:
            other, name = found[provider.ConsumeIntInRange(0, len(found) - 1)]
            container[key] = copy.deepcopy(other[name])
        else:
            del container[key]
            if not document:
                break
    changed = bytearray(binary)
    for _ in range(provider.ConsumeIntInRange(0, 8)):
        changed[provider.ConsumeIntInRange(0, len(changed) - 1)] = provider.ConsumeIntInRange(
            0, 255
        )
    return pack(json.dumps(document).encode(), bytes(changed))


def one_input(data: bytes) -> None:
    """Read one file, and if it is accepted write it and read it again."""
    provider = atheris.FuzzedDataProvider(data)
    kind = provider.ConsumeIntInRange(0, 7)
    mode = MODES[provider.ConsumeIntInRange(0, 2)]
    compress = COMPRESSIONS[provider.ConsumeIntInRange(0, 2)]
    if kind == 0:
        glb = provider.ConsumeBytes(len(data))
    elif kind == 1:
        glb = pack(provider.ConsumeBytes(len(data)), b"\0" * 64)
    else:
        glb = edited_file(provider)
    try:
        scene = Scene(glb, LIMITS)
    except InputError:
        return
    soup = scene.soup
    written = Scene(scene.write(separate_faces(len(soup.faces)), mode, compress=compress))
    before, after = soup.positions[soup.faces], written.soup.positions[written.soup.faces]
    if compress != "meshopt" and not np.array_equal(before, after):
        raise AssertionError("the triangles changed")
    if len(before) != len(after):
        raise AssertionError("the number of triangles changed")


if __name__ == "__main__":
    atheris.Setup(sys.argv, one_input)
    atheris.Fuzz()
