"""Reading the weights from a file that may be damaged or hostile.

Two containers are read: the zip archive of `torch.save`, as Lightning wrote the published file,
and safetensors. Nothing in the file is ever called: the archive goes through torch's weights-only
unpickler, and a pickle that names anything but tensors and plain containers is refused before.
"""

import errno
import hashlib
import struct
import zipfile
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import torch
from partuv_contract.errors import CheckpointError
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file
from torch import Tensor

from partuv_worker.features.partfield.network import PartFieldNetwork, expected_parameters
from partuv_worker.features.partfield.shape import NetworkShape

HASH_KEY = "partuv.weights_sha256"
# The published file's training settings are an object of this class; they are read as a plain
# mapping and dropped, so the package that defines it is not needed.
SETTINGS_CLASS = "yacs.config.CfgNode"
HARMLESS_GLOBALS = frozenset({SETTINGS_CLASS, "builtins.set", "__builtin__.set"})
PICKLE_LIMIT_BYTES = 1 << 26
DIFFERENCES_SHOWN = 6


@dataclass(frozen=True)
class Checkpoint:
    """All tensors of the network, and a hash that names them whatever file they came from."""

    path: Path
    container: str  # "torch archive" or "safetensors"
    state: dict[str, Tensor]
    weights_sha256: str

    def network(self, shape: NetworkShape | None = None) -> PartFieldNetwork:
        """A network with these weights, ready for inference; shares their memory."""
        with torch.device("meta"):
            network = PartFieldNetwork(shape)
        network.load_state_dict(self.state, strict=True, assign=True)
        return network.requires_grad_(False).eval()


def read_checkpoint(path: Path, shape: NetworkShape | None = None) -> Checkpoint:
    """Read and verify a checkpoint; raises `CheckpointError` with the reason."""
    container = _container(path)
    if container == "torch archive":
        _check_archive(path)
        tensors, stated_hash = _archive_tensors(path), None
    else:
        tensors, stated_hash = _safetensors_tensors(path)
    _check_tensors(path, tensors, expected_parameters(shape))
    # Out of the mapped file: it may change or vanish while the network lives.
    state = {name: tensors[name].detach().clone().contiguous() for name in sorted(tensors)}
    for name, tensor in state.items():
        if not torch.isfinite(tensor).all():
            raise CheckpointError(f"{path.name}: tensor {name} holds values that are not finite")
    digest = _weights_sha256(state)
    if stated_hash not in (None, digest):
        raise CheckpointError(
            f"{path.name}: damaged, the weights do not match the file's own checksum"
        )
    return Checkpoint(path, container, state, digest)


def write_safetensors(checkpoint: Checkpoint, path: Path) -> None:
    """Write the weights with their checksum; training state is left behind.

    The file appears under its name only when it is complete; raises `OSError` if it can't be.
    """
    partial = path.with_name(path.name + ".partial")
    partial.touch()
    mode = partial.stat().st_mode  # what this user's files usually get; save_file makes it private
    try:
        save_file(checkpoint.state, partial, metadata={HASH_KEY: checkpoint.weights_sha256})
        partial.chmod(mode)
        partial.replace(path)
    except SafetensorError as failure:
        raise OSError(errno.EIO, str(failure), str(path)) from failure
    finally:
        partial.unlink(missing_ok=True)


def file_sha256(path: Path) -> str:
    """Hash of the file as it lies on disk, to compare with a published one."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _container(path: Path) -> str:
    try:
        with path.open("rb") as file:
            head = file.read(9)
            size_bytes = file.seek(0, 2)
    except OSError as failure:
        raise CheckpointError(f"{path.name}: can't be read ({failure.strerror})") from failure
    if head.startswith(b"PK\x03\x04"):
        return "torch archive"
    if len(head) == 9 and head[8:] == b"{" and struct.unpack("<Q", head[:8])[0] < size_bytes:
        return "safetensors"
    raise CheckpointError(
        f"{path.name}: cut short, or neither a torch checkpoint (zip archive) nor safetensors"
    )


def _check_archive(path: Path) -> None:
    """Refuse an archive that is damaged, or that two readers could understand differently."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = archive.infolist()
            names = [entry.filename for entry in entries]
            pickles = [entry for entry in entries if entry.filename.endswith("data.pkl")]
            if len(set(names)) != len(names) or len(pickles) != 1:
                raise CheckpointError(f"{path.name}: not the archive of one torch checkpoint")
            if any(entry.compress_type != zipfile.ZIP_STORED for entry in entries):
                raise CheckpointError(f"{path.name}: holds compressed entries, torch writes none")
            if pickles[0].file_size > PICKLE_LIMIT_BYTES:
                raise CheckpointError(f"{path.name}: its object list is larger than any network's")
            damaged = archive.testzip()
    except (zipfile.BadZipFile, OSError, EOFError, NotImplementedError, ValueError) as failure:
        raise CheckpointError(f"{path.name}: damaged or cut short ({failure})") from failure
    if damaged is not None:
        raise CheckpointError(f"{path.name}: damaged, checksum of entry {damaged} does not match")


def _archive_tensors(path: Path) -> dict[str, Tensor]:
    # Any exception here is torch's way of saying that the file is not what it should be.
    try:
        named = set(torch.serialization.get_unsafe_globals_in_checkpoint(path))
    except Exception as failure:
        raise CheckpointError(f"{path.name}: its object list is damaged ({failure})") from failure
    calls = sorted(named - HARMLESS_GLOBALS)
    if calls:
        raise CheckpointError(f"{path.name}: refused, loading it would call {', '.join(calls)}")
    try:
        with torch.serialization.safe_globals([(OrderedDict, SETTINGS_CLASS), set]):
            content: Any = torch.load(path, map_location="cpu", weights_only=True, mmap=True)
    except Exception as failure:
        raise CheckpointError(f"{path.name}: can't be loaded safely ({failure})") from failure
    if isinstance(content, Mapping) and isinstance(content.get("state_dict"), Mapping):
        content = content["state_dict"]
    if not isinstance(content, Mapping) or not all(
        isinstance(name, str) and isinstance(tensor, Tensor) for name, tensor in content.items()
    ):
        raise CheckpointError(f"{path.name}: holds no state_dict of named tensors")
    return dict(content)


def _safetensors_tensors(path: Path) -> tuple[dict[str, Tensor], str | None]:
    try:
        with safe_open(path, framework="pt", device="cpu") as file:
            stated = (file.metadata() or {}).get(HASH_KEY)
            return {name: file.get_tensor(name) for name in file.keys()}, stated  # noqa: SIM118
    except (SafetensorError, OSError, ValueError) as failure:
        raise CheckpointError(f"{path.name}: damaged or cut short ({failure})") from failure


def _check_tensors(
    path: Path, tensors: dict[str, Tensor], expected: dict[str, tuple[int, ...]]
) -> None:
    differences = [f"missing {name}" for name in sorted(expected.keys() - tensors.keys())]
    differences += [f"unknown {name}" for name in sorted(tensors.keys() - expected.keys())]
    for name in sorted(expected.keys() & tensors.keys()):
        shape, dtype = tuple(tensors[name].shape), tensors[name].dtype
        if shape != expected[name]:
            differences.append(f"{name} is {list(shape)}, not {list(expected[name])}")
        elif dtype != torch.float32 or tensors[name].layout != torch.strided:
            differences.append(f"{name} is {dtype}, not torch.float32")
    if differences:
        shown = "; ".join(differences[:DIFFERENCES_SHOWN])
        more = len(differences) - DIFFERENCES_SHOWN
        raise CheckpointError(
            f"{path.name}: not the PartField network: {shown}"
            + (f"; {more} more" if more > 0 else "")
        )


def _weights_sha256(state: dict[str, Tensor]) -> str:
    digest = hashlib.sha256()
    for name in sorted(state):
        digest.update(f"{name}{list(state[name].shape)}\n".encode())
        digest.update(state[name].numpy().data)
    return digest.hexdigest()
