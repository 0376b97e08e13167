"""Checkpoints that are what they should be, damaged ones and hostile ones."""

import os
import pickle
import re
import zipfile
from collections import OrderedDict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import safetensors.torch
import torch
from partuv_contract.errors import CheckpointError
from partuv_worker.features.cli import command
from partuv_worker.features.partfield import checkpoint as checkpoint_module
from partuv_worker.features.partfield.checkpoint import read_checkpoint, write_safetensors
from partuv_worker.features.partfield.network import PartFieldNetwork, expected_parameters
from partuv_worker.features.partfield.shape import NetworkShape
from torch import Tensor

from tests.support.partfield import write_lightning_file

State = dict[str, Tensor]


@pytest.fixture
def state(tiny_network: PartFieldNetwork) -> State:
    return dict(tiny_network.state_dict())


class Call:
    """Pickles as a call: what a hostile file is made of."""

    def __init__(self, function: Callable[..., Any], *arguments: Any) -> None:
        self.call = (function, arguments)

    def __reduce__(self) -> Any:
        return self.call


def test_wrapped_and_bare_archives_give_the_weights(
    tmp_path: Path, state: State, tiny_shape: NetworkShape
) -> None:
    wrapped = write_lightning_file(tmp_path / "wrapped.ckpt", state)
    bare = tmp_path / "bare.ckpt"
    torch.save(state, bare)
    hashes = set()
    for path in (wrapped, bare):
        read = read_checkpoint(path, tiny_shape)
        assert read.container == "torch archive"
        assert read.state.keys() == state.keys()
        assert all(torch.equal(read.state[name], state[name]) for name in state)
        hashes.add(read.weights_sha256)
    assert len(hashes) == 1


def test_conversion_keeps_weights_and_hash(
    tmp_path: Path, state: State, tiny_shape: NetworkShape
) -> None:
    original = read_checkpoint(write_lightning_file(tmp_path / "a.ckpt", state), tiny_shape)
    target = tmp_path / "a.safetensors"
    write_safetensors(original, target)
    converted = read_checkpoint(target, tiny_shape)
    assert converted.container == "safetensors"
    assert target.stat().st_mode == original.path.stat().st_mode, "others may read it as usual"
    assert converted.weights_sha256 == original.weights_sha256
    assert all(torch.equal(converted.state[name], state[name]) for name in state)
    assert [file.name for file in tmp_path.iterdir() if "partial" in file.name] == []


def test_other_weights_have_another_hash(
    tmp_path: Path, state: State, tiny_shape: NetworkShape
) -> None:
    torch.save(state, tmp_path / "a.ckpt")
    state["logit_scale"] = state["logit_scale"] + 1
    torch.save(state, tmp_path / "b.ckpt")
    a, b = (read_checkpoint(tmp_path / name, tiny_shape) for name in ("a.ckpt", "b.ckpt"))
    assert a.weights_sha256 != b.weights_sha256


def test_the_network_runs_with_the_weights(
    tmp_path: Path, state: State, tiny_network: PartFieldNetwork, tiny_shape: NetworkShape
) -> None:
    torch.save(state, tmp_path / "a.ckpt")
    network = read_checkpoint(tmp_path / "a.ckpt", tiny_shape).network(tiny_shape)
    (tmp_path / "a.ckpt").unlink()
    points = torch.rand(50, 3) - 0.5
    with torch.inference_mode():
        assert torch.equal(network(points), tiny_network(points))


def drop(state: State) -> None:
    del state["logit_scale"]


def add(state: State) -> None:
    state["extra.weight"] = torch.zeros(2)


def reshape(state: State) -> None:
    state["logit_scale"] = torch.zeros(2)


def halve(state: State) -> None:
    state["logit_scale"] = state["logit_scale"].half()


def sparsify(state: State) -> None:
    state["logit_scale"] = state["logit_scale"].to_sparse()


def spoil(state: State) -> None:
    state["logit_scale"] = torch.tensor([float("nan")])


def inflate(state: State) -> None:
    state["pvcnn.unet_encoder.norm_out.bias"] = torch.zeros(1).expand(1 << 40)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (drop, "missing logit_scale"),
        (add, "unknown extra.weight"),
        (reshape, r"logit_scale is \[2\], not \[1\]"),
        (halve, "logit_scale is torch.float16"),
        (sparsify, "logit_scale"),
        (spoil, "logit_scale holds values that are not finite"),
        (inflate, "norm_out.bias is"),
    ],
)
def test_weights_of_something_else_are_refused(
    tmp_path: Path,
    state: State,
    tiny_shape: NetworkShape,
    change: Callable[[State], None],
    message: str,
) -> None:
    change(state)
    torch.save(state, tmp_path / "a.ckpt")
    with pytest.raises(CheckpointError, match=message):
        read_checkpoint(tmp_path / "a.ckpt", tiny_shape)


def test_many_differences_are_counted(tmp_path: Path, tiny_shape: NetworkShape) -> None:
    torch.save({}, tmp_path / "a.ckpt")
    more = len(expected_parameters(tiny_shape)) - 6
    with pytest.raises(CheckpointError, match=f"; {more} more"):
        read_checkpoint(tmp_path / "a.ckpt", tiny_shape)


@pytest.mark.parametrize("content", [[1, 2], "text", {"state_dict": [1]}, {"a": 1}, 7])
def test_archives_without_weights_are_refused(
    tmp_path: Path, tiny_shape: NetworkShape, content: Any
) -> None:
    torch.save(content, tmp_path / "a.ckpt")
    with pytest.raises(CheckpointError, match="no state_dict"):
        read_checkpoint(tmp_path / "a.ckpt", tiny_shape)


@pytest.mark.parametrize("suffix", [".ckpt", ".safetensors"])
def test_files_cut_short_are_refused(
    tmp_path: Path, state: State, tiny_shape: NetworkShape, suffix: str
) -> None:
    whole = tmp_path / f"whole{suffix}"
    torch.save(state, tmp_path / "whole.ckpt")
    if suffix == ".safetensors":
        write_safetensors(read_checkpoint(tmp_path / "whole.ckpt", tiny_shape), whole)
    content = whole.read_bytes()
    cut = tmp_path / f"cut{suffix}"
    for length in (0, 5, 9, 100, len(content) // 2, len(content) - 1):
        cut.write_bytes(content[:length])
        with pytest.raises(CheckpointError, match=re.escape(cut.name)):
            read_checkpoint(cut, tiny_shape)


@pytest.mark.parametrize("suffix", [".ckpt", ".safetensors"])
def test_one_flipped_bit_in_the_weights_is_noticed(
    tmp_path: Path, state: State, tiny_shape: NetworkShape, suffix: str
) -> None:
    path = tmp_path / f"a{suffix}"
    torch.save(state, tmp_path / "a.ckpt")
    if suffix == ".safetensors":
        write_safetensors(read_checkpoint(tmp_path / "a.ckpt", tiny_shape), path)
    content = bytearray(path.read_bytes())
    name = "triplane_transformer.pos_embed"
    content[content.index(state[name].numpy().tobytes()) + 40] ^= 1
    path.write_bytes(content)
    with pytest.raises(CheckpointError, match="damaged"):
        read_checkpoint(path, tiny_shape)


def test_missing_files_and_folders_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path, tmp_path / "absent.ckpt"):
        with pytest.raises(CheckpointError, match="can't be read"):
            read_checkpoint(path)


def test_safetensors_header_that_claims_too_much_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.safetensors"
    header = b'{"logit_scale":{"dtype":"F32","shape":[1],"data_offsets":[0,99999999]}}'
    path.write_bytes(len(header).to_bytes(8, "little") + header)
    with pytest.raises(CheckpointError, match="damaged"):
        read_checkpoint(path)
    path.write_bytes((1 << 60).to_bytes(8, "little") + header)
    with pytest.raises(CheckpointError, match="neither"):
        read_checkpoint(path)


@pytest.mark.parametrize("place", ["root", "state_dict", "tensor", "hyper_parameters"])
def test_files_that_call_something_are_refused_and_nothing_is_called(
    tmp_path: Path, state: State, tiny_shape: NetworkShape, place: str
) -> None:
    traces = tmp_path / "traces"
    call: Any = Call(os.mkdir, str(traces))
    content: Any = {
        "root": call,
        "state_dict": {"state_dict": call},
        "tensor": {"state_dict": OrderedDict(state) | {"logit_scale": call}},
        "hyper_parameters": {"state_dict": OrderedDict(state), "hyper_parameters": call},
    }[place]
    torch.save(content, tmp_path / "a.ckpt")
    with pytest.raises(CheckpointError, match=r"refused, loading it would call .*mkdir"):
        read_checkpoint(tmp_path / "a.ckpt", tiny_shape)
    assert not traces.exists()


def test_calls_under_the_settings_class_name_find_only_a_mapping(
    tmp_path: Path, state: State, tiny_shape: NetworkShape
) -> None:
    """A pickle may call what it may name; the names it may use stand for containers."""
    traces = tmp_path / "traces"
    torch.save(state, tmp_path / "a.ckpt")
    hostile = (
        b"\x80\x02cyacs.config\nCfgNode\n(S'os'\nS'mkdir'\ntR(S'" + str(traces).encode() + b"'\ntR."
    )
    replace_pickle(tmp_path / "a.ckpt", hostile)
    with pytest.raises(CheckpointError):
        read_checkpoint(tmp_path / "a.ckpt", tiny_shape)
    assert not traces.exists()


def test_plain_and_tar_pickles_are_never_opened(tmp_path: Path, state: State) -> None:
    traces = tmp_path / "traces"
    plain = tmp_path / "plain.ckpt"
    plain.write_bytes(pickle.dumps(Call(os.mkdir, str(traces))))
    legacy = tmp_path / "legacy.ckpt"
    torch.save(state, legacy, _use_new_zipfile_serialization=False)
    for path in (plain, legacy):
        with pytest.raises(CheckpointError, match="neither"):
            read_checkpoint(path)
    assert not traces.exists()


def test_archives_that_readers_could_understand_differently_are_refused(
    tmp_path: Path, state: State, tiny_shape: NetworkShape
) -> None:
    good, bad = tmp_path / "good.ckpt", tmp_path / "bad.ckpt"
    torch.save(state, good)
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(bad, "w") as target:
        for entry in source.infolist():
            target.writestr(entry.filename, source.read(entry))
        target.writestr("other/data.pkl", pickle.dumps(Call(os.mkdir, "traces")))
    with pytest.raises(CheckpointError, match="not the archive of one torch checkpoint"):
        read_checkpoint(bad, tiny_shape)
    with zipfile.ZipFile(good) as source, zipfile.ZipFile(bad, "w", zipfile.ZIP_DEFLATED) as target:
        for entry in source.infolist():
            target.writestr(entry.filename, source.read(entry))
    with pytest.raises(CheckpointError, match="compressed"):
        read_checkpoint(bad, tiny_shape)


def test_nonsense_pickles_are_refused(
    tmp_path: Path, state: State, tiny_shape: NetworkShape
) -> None:
    for content in (
        b"",
        b".",
        b"\x80\x02}",
        b"\x80\x02]q\x00(h\x05e.",
        b"\x80\x04\x95" + b"\xff" * 8,
    ):
        torch.save(state, tmp_path / "a.ckpt")
        replace_pickle(tmp_path / "a.ckpt", content)
        with pytest.raises(CheckpointError, match=r"a\.ckpt"):
            read_checkpoint(tmp_path / "a.ckpt", tiny_shape)


def replace_pickle(path: Path, content: bytes) -> None:
    with zipfile.ZipFile(path) as source:
        entries = [(entry.filename, source.read(entry)) for entry in source.infolist()]
    with zipfile.ZipFile(path, "w") as target:
        for name, data in entries:
            target.writestr(name, content if name.endswith("data.pkl") else data)


@pytest.fixture
def tiny_expected(monkeypatch: pytest.MonkeyPatch, tiny_shape: NetworkShape) -> None:
    """The command has no option for the network's size; it is to expect the tiny one here."""
    monkeypatch.setattr(
        checkpoint_module, "expected_parameters", lambda shape: expected_parameters(tiny_shape)
    )


@pytest.mark.usefixtures("tiny_expected")
def test_commands_check_and_convert(
    tmp_path: Path, state: State, capsys: pytest.CaptureFixture[str]
) -> None:
    source, target = tmp_path / "a.ckpt", tmp_path / "a.safetensors"
    torch.save(state, source)
    assert command(["check", str(source)]) == 0
    checked = capsys.readouterr().out
    assert "no damage found" in checked
    assert "not the published file" in checked
    assert command(["convert", str(source), str(target)]) == 0
    assert safetensors.torch.load_file(target).keys() == state.keys()
    assert command(["check", str(target)]) == 0
    weights = re.search(r"weights .*", checked)
    assert weights is not None
    assert weights.group() in capsys.readouterr().out


def test_commands_refuse_with_a_reason(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    source = tmp_path / "a.ckpt"
    torch.save(Call(os.mkdir, str(tmp_path / "traces")), source)
    assert command(["check", str(source)]) == 3
    assert "refused" in capsys.readouterr().err
    assert command(["convert", str(source), str(tmp_path / "b.safetensors")]) == 3
    assert command(["convert", str(source), str(tmp_path / "b.ckpt")]) == 2
    assert "must end with .safetensors" in capsys.readouterr().err
    assert sorted(file.name for file in tmp_path.iterdir()) == ["a.ckpt"]


@pytest.mark.usefixtures("tiny_expected")
def test_a_file_that_cannot_be_written_is_told(
    tmp_path: Path, state: State, capsys: pytest.CaptureFixture[str]
) -> None:
    source = tmp_path / "a.ckpt"
    torch.save(state, source)
    assert command(["convert", str(source), str(tmp_path / "absent" / "b.safetensors")]) == 4
    assert "absent" in capsys.readouterr().err
