import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from partuv_contract.errors import LimitError, MalformedGlbError
from partuv_worker.glb.container import Chunk
from partuv_worker.glb.jsontext import format_json, parse_json
from partuv_worker.glb.limits import Limits

LIMITS = Limits(json_depth=16, json_values=2000)
OFFSET = 20


def parse(text, limits=LIMITS):
    data = text if isinstance(text, bytes) else text.encode()
    return parse_json(Chunk(0, OFFSET, memoryview(data)), limits)


values = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-(2**53), 2**53)
    | st.floats(allow_nan=False, allow_infinity=False)
    | st.text(),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(), inner, max_size=4),
    max_leaves=20,
)


@given(st.dictionaries(st.text(), values, max_size=5), st.booleans())
def test_reads_and_writes_every_document_unchanged(document, escaped):
    text = json.dumps(document, ensure_ascii=escaped)
    parsed = parse(text.encode("utf-8", "surrogatepass") if escaped else text)
    assert parsed == document
    assert parse(format_json(parsed)) == document


def test_half_a_surrogate_pair_survives():
    assert format_json(parse('{"name":"\\ud800"}')) == b'{"name":"\\ud800"}'


def test_keeps_the_order_of_keys_and_the_kind_of_numbers():
    text = b'{"b":1,"a":1.0,"c":[-0.0,1e-05,12345678901234]}'
    assert format_json(parse(text)) == text


@pytest.mark.parametrize("text", ["[", "{", '{"a":[]}]', '{"a" 1}', '{"a":"', '"', "", "[1,]"])
def test_broken_json_is_malformed(text):
    with pytest.raises(MalformedGlbError):
        parse(text)


@pytest.mark.parametrize("root", ["[]", "null", "3", '"x"'])
def test_the_root_must_be_an_object(root):
    with pytest.raises(MalformedGlbError):
        parse(root)


@pytest.mark.parametrize(
    "value", ["NaN", "Infinity", "-Infinity", "1e999", "1" * 5000, '{"k":1,"k":2}']
)
def test_refuses_what_json_parsers_disagree_on(value):
    with pytest.raises(MalformedGlbError):
        parse(f'{{"a":{value}}}')


def test_a_syntax_error_is_located_in_the_file():
    with pytest.raises(MalformedGlbError) as caught:
        parse('{"ä":1,x}')
    assert caught.value.byte_offset == OFFSET + len('{"ä":1,'.encode())
    with pytest.raises(MalformedGlbError) as caught:
        parse(b'{"a":"\xff"}')
    assert caught.value.byte_offset == OFFSET + 6


def test_depth_is_bounded_before_parsing():
    deep = '{"a":' + "[" * 15 + "]" * 15 + "}"
    assert parse(deep)
    with pytest.raises(LimitError) as caught:
        parse('{"a":' + "[" * 16 + "]" * 16 + "}")
    assert caught.value.byte_offset == OFFSET + 5 + 15
    with pytest.raises(LimitError):
        parse("[" * 1_000_000)


def test_the_number_of_values_is_bounded_before_parsing():
    assert parse('{"a":[' + "0," * 1990 + "0]}")
    with pytest.raises(LimitError):
        parse('{"a":[' + "0," * 2000 + "0]}")


def test_brackets_and_quotes_in_strings_do_not_count():
    nested = '{"a":"' + "[" * 100 + '","b":"\\"' + "[" * 100 + '","c":"\\\\","d":[1]}'
    assert parse(nested)["d"] == [1]
    with pytest.raises(LimitError):
        parse('{"a":"\\\\","b":' + "[" * 20 + '"\\""' + "]" * 20 + "}")
