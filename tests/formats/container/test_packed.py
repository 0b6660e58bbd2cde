"""Packed blocks of bytes, deflated or plain."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.container import packed


@given(st.binary(max_size=40).map(lambda data: data * 9) | st.binary())
def test_blocks_round_trip(data: bytes) -> None:
    block = packed.packed(data)
    assert packed.unpacked(b"x" + block + b"y", 1, len(data)) == (data, 1 + len(block))
    assert packed.unpacked_size(block, 0) == len(data)
    assert len(block) <= len(data) + 6
