"""Makes the gRPC code from unwrap.proto and docs/openapi.json from the gateway's routes.

`python proto/generate.py` writes them; with --check it only tells what is not current. Options
that UnwrapOptions has and the proto has not yet are added to the proto first, with the next free
numbers. Numbers in use are never changed: old clients rely on them.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tempfile
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER))

from partuv_contract.option_table import OptionInfo, option_table  # noqa: E402

PROTO = FOLDER / "partuv" / "v1" / "unwrap.proto"
# The messages belong to the contract; what needs grpc belongs to the service.
OPENAPI = FOLDER.parent / "docs" / "openapi.json"
TARGETS = {
    "unwrap_pb2.py": FOLDER / "partuv_contract" / "pb" / "unwrap_pb2.py",
    "unwrap_pb2.pyi": FOLDER / "partuv_contract" / "pb" / "unwrap_pb2.pyi",
    "unwrap_pb2_grpc.py": FOLDER.parent
    / "service"
    / "partuv_service"
    / "rpc"
    / "unwrap_pb2_grpc.py",
}
_TYPES = {"number": "double", "integer": "int64", "boolean": "bool", "string": "string"}
_MESSAGE = re.compile(r"(?<=^message UnwrapOptions \{\n)(.*?)(?=^\})", re.MULTILINE | re.DOTALL)


def with_all_options(source: str) -> str:
    """The proto with a field for every option."""
    found = _MESSAGE.search(source)
    assert found is not None
    body = found[1]
    numbers = [int(number) for number in re.findall(r"= (\d+);", body)]
    names = set(re.findall(r"(\w+) = \d+;", body))
    number = max(numbers, default=0)
    for info in option_table():
        if info.name not in names:
            number += 1
            body += f"  // {info.meaning}\n  {_type_of(info)} {info.name} = {number};\n"
    return source[: found.start()] + body + source[found.end() :]


def _type_of(info: OptionInfo) -> str:
    schema = info.value_schema
    kinds = [one for one in schema.get("anyOf", [schema]) if one.get("type") != "null"]
    if len(kinds) > 1:
        return "optional string"
    if kinds[0].get("type") == "array":
        return f"repeated {_TYPES[kinds[0]['items']['type']]}"
    return f"optional {_TYPES[kinds[0]['type']]}"


def generated(source: str) -> dict[str, str]:
    """The content of each target, made by protoc."""
    with tempfile.TemporaryDirectory() as folder:
        virtual = Path(folder) / "in" / "partuv_contract" / "pb"
        virtual.mkdir(parents=True)
        (virtual / "unwrap.proto").write_text(source)
        out = Path(folder) / "out"
        out.mkdir()
        subprocess.run(
            [
                *(sys.executable, "-m", "grpc_tools.protoc", f"-I{folder}/in"),
                *(f"--python_out={out}", f"--pyi_out={out}", f"--grpc_python_out={out}"),
                "partuv_contract/pb/unwrap.proto",
            ],
            check=True,
        )
        made = out / "partuv_contract" / "pb"
        return {name: (made / name).read_text() for name in TARGETS}


def openapi() -> str:
    """The gateway's OpenAPI document."""
    from partuv_service.main import create_app
    from partuv_service.settings import Settings

    return json.dumps(create_app(Settings()).openapi(), indent=1, ensure_ascii=False) + "\n"


def main() -> int:
    """Write, or check, all of it."""
    check = "--check" in sys.argv[1:]
    source = PROTO.read_text()
    complete = with_all_options(source)
    wanted = {PROTO: complete, OPENAPI: openapi()}
    wanted |= {TARGETS[name]: text for name, text in generated(complete).items()}
    stale = [
        path for path, text in wanted.items() if not path.is_file() or path.read_text() != text
    ]
    for path in stale:
        if check:
            print(f"stale: {path.relative_to(FOLDER.parent)}; run python proto/generate.py")
        else:
            path.write_text(wanted[path])
    return 1 if check and stale else 0


if __name__ == "__main__":
    sys.exit(main())
