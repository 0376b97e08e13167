import struct

import pytest
from partuv_contract.errors import LimitError, MalformedGlbError, NotGlbError
from partuv_worker.glb.container import join_container, split_container
from partuv_worker.glb.limits import Limits

from tests.support.glb_builder import pack


def test_finds_the_chunks_and_joins_them_again():
    data = pack({"asset": {}}, b"12345678", (0x12345678, b"abcd"))
    container = split_container(data, Limits())
    assert bytes(container.json.content).rstrip() == b'{"asset": {}}'
    assert data[container.json.offset :].startswith(b'{"asset"')
    assert container.binary == b"12345678"
    joined = join_container(bytes(container.json.content), [container.binary], container.others)
    assert joined == data


@pytest.mark.parametrize(
    ("data", "error", "offset"),
    [
        (b"", NotGlbError, 0),
        (b"glTF\x02\0\0\0", NotGlbError, 0),
        (struct.pack("<4sII", b"glTF", 1, 12), NotGlbError, 4),
        (struct.pack("<4sII", b"glTF", 2, 13), MalformedGlbError, 8),
        (struct.pack("<4sII", b"glTF", 2, 12), MalformedGlbError, 12),
        (struct.pack("<4sIII", b"glTF", 2, 16, 0), MalformedGlbError, 12),
        (struct.pack("<4sIIII", b"glTF", 2, 20, 4, 0x4E4F534A), MalformedGlbError, 12),
        (struct.pack("<4sIIII2x", b"glTF", 2, 22, 2, 0x4E4F534A), MalformedGlbError, 12),
        (struct.pack("<4sIIII", b"glTF", 2, 20, 0, 0x004E4942), MalformedGlbError, 12),
        (pack({}, b"", (0x004E4942, b"")), MalformedGlbError, 32),
    ],
)
def test_refuses_a_broken_container_and_says_at_which_byte(data, error, offset):
    with pytest.raises(error) as caught:
        split_container(data, Limits())
    assert caught.value.byte_offset == offset


def test_bounds_the_file_and_its_json():
    data = pack({"asset": {}}, None)
    with pytest.raises(LimitError):
        split_container(data, Limits(file_bytes=len(data) - 1))
    with pytest.raises(LimitError):
        split_container(data, Limits(json_bytes=8))
