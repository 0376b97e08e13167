"""`partuv features`: verify a PartField checkpoint, or convert it to safetensors."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

from partuv_contract.errors import ComponentMissingError, PartuvError

# SHA-256 of `model_objaverse.ckpt` as users of the published file report it.
PUBLISHED_SHA256 = "463efc8a3afd3913142aa025e0125c00f16ef452b8de6a132ebe32bbe7877ee4"
EXIT_DONE, EXIT_USAGE, EXIT_REFUSED, EXIT_FILES = 0, 2, 3, 4


def command(arguments: Sequence[str]) -> int:
    """Verify or convert a PartField checkpoint."""
    parser = argparse.ArgumentParser(
        prog="partuv features",
        description=command.__doc__,
        epilog="exit codes: 0 done; 2 wrong arguments; 3 the checkpoint was refused; "
        "4 a file could not be written",
    )
    actions = parser.add_subparsers(dest="action", required=True)
    check = actions.add_parser("check", help="verify that a file holds the network, undamaged")
    check.add_argument("checkpoint", type=Path)
    convert = actions.add_parser("convert", help="write the weights alone, as safetensors")
    convert.add_argument("checkpoint", type=Path)
    convert.add_argument("output", type=Path)
    parsed = parser.parse_args(arguments)
    if parsed.action == "convert" and parsed.output.suffix != ".safetensors":
        return _complain("the output's name must end with .safetensors", EXIT_USAGE)
    try:
        if parsed.action == "check":
            _check(parsed.checkpoint)
        else:
            _convert(parsed.checkpoint, parsed.output)
    except PartuvError as refusal:
        return _complain(str(refusal), EXIT_REFUSED)
    except OSError as failure:
        return _complain(f"{failure.filename or 'file'}: {failure.strerror}", EXIT_FILES)
    return EXIT_DONE


def _complain(message: str, code: int) -> int:
    print(f"partuv features: {message}", file=sys.stderr)
    return code


def _check(path: Path) -> None:
    reader = _reader()
    checkpoint = reader.read_checkpoint(path)
    file_hash = reader.file_sha256(path)
    published = "the published file" if file_hash == PUBLISHED_SHA256 else "not the published file"
    print(f"{path}: {checkpoint.container}, {len(checkpoint.state)} tensors, no damage found")
    print(f"file     sha256:{file_hash} ({published})")
    print(f"weights  sha256:{checkpoint.weights_sha256}")


def _convert(path: Path, output: Path) -> None:
    reader = _reader()
    checkpoint = reader.read_checkpoint(path)
    reader.write_safetensors(checkpoint, output)
    print(f"{output}: {output.stat().st_size} bytes, weights sha256:{checkpoint.weights_sha256}")


def _reader() -> ModuleType:
    try:
        from partuv_worker.features.partfield import checkpoint
    except ImportError as failure:
        raise ComponentMissingError(
            "the features command needs torch and safetensors; "
            "try: pip install 'partuv-service[partfield]'"
        ) from failure
    return checkpoint
