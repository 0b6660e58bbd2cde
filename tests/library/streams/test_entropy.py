"""Streams of the range coder: where they end, and where a fault in them is."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding.coder import Coder, code_raw
from deltamesh._kernels.coding.models import Model
from deltamesh._streams.entropy import check_end, decode_with, decoder, encode_with
from deltamesh_formats.errors import FormatError

MODEL = Model(1, ((1, 255),))
numbers = st.lists(st.integers(0, 2**16 - 1), min_size=1, max_size=20)


def encoded(values: list[int]) -> bytes:
    return encode_with(MODEL, len(values), lambda coder: read(coder, values))


def read(coder: Coder, values: list[int]) -> list[int]:
    return [int(code_raw(coder, value, 16)) for value in values]


@given(numbers)
def test_what_is_written_is_read(values: list[int]) -> None:
    data = encoded(values)
    zeros = [0] * len(values)
    assert decode_with(MODEL, data, lambda coder: read(coder, zeros)) == values


@given(numbers, st.binary(min_size=1, max_size=4))
def test_a_stream_that_goes_on_is_refused_where_it_should_end(
    values: list[int], more: bytes
) -> None:
    data = encoded(values)
    for stream in (data + more, data + more + b"\0"):
        offset, found = None, []
        try:
            found = decode_with(MODEL, stream, lambda coder: read(coder, [0] * len(values)), 500)
        except FormatError as error:
            offset = error.offset
        assert encoded(found) == stream if offset is None else 500 <= offset <= 500 + len(stream)


def test_a_zero_at_the_end_is_named() -> None:
    coder = decoder(b"\1\0", *MODEL)
    with pytest.raises(FormatError, match="a zero byte at the end of a stream") as caught:
        check_end(coder, 30)
    assert caught.value.offset == 31


def test_a_stream_of_nothing_is_empty() -> None:
    assert encode_with(MODEL, 0, lambda coder: None) == b""
    assert decode_with(MODEL, b"", lambda coder: "read") == "read"
    with pytest.raises(FormatError, match="does not end where it should"):
        decode_with(MODEL, b"\1", lambda coder: None)
