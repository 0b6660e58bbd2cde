"""Packed blocks of bytes: plain, deflated, in a zstandard frame."""

from __future__ import annotations

import tracemalloc
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats import zstd_frames
from deltamesh_formats.container import packed
from deltamesh_formats.container.fields import write_varint
from deltamesh_formats.container.payload_layout import BLOCK_DEFLATED, BLOCK_PLAIN, BLOCK_ZSTD
from deltamesh_formats.errors import FormatError

NAMES = [f"Object_{i:04}_LOD0" for i in range(3000)]


def zstd_block(frame: bytes, size: int) -> bytes:
    return bytes([BLOCK_ZSTD]) + write_varint(size) + write_varint(len(frame)) + frame


@given(st.binary(max_size=40).map(lambda data: data * 9) | st.binary())
def test_blocks_round_trip(data: bytes) -> None:
    block = packed.packed(data)
    assert packed.unpacked(b"x" + block + b"y", 1, len(data)) == (data, 1 + len(block))
    assert packed.unpacked_size(block, 0) == len(data)
    assert len(block) <= len(data) + 6


@pytest.mark.parametrize(
    ("data", "form"),
    [
        (b"a name", BLOCK_PLAIN),
        (b"a name again, " * 9, BLOCK_DEFLATED),
        ("".join(NAMES).encode(), BLOCK_ZSTD),
    ],
)
def test_the_smallest_form_is_chosen(data: bytes, form: int) -> None:
    block = packed.packed(data)
    assert block[0] == form
    assert packed.unpacked(block, 0, len(data)) == (data, len(block))


@pytest.mark.parametrize(("count", "most"), [(300, 400), (3000, 1200)])
def test_numbered_names_take_few_bytes(count: int, most: int) -> None:
    block = packed.packed("\n".join(NAMES[:count]).encode())
    assert len(block) < most
    assert len(block) < len(packed._deflated("\n".join(NAMES[:count]).encode())) / 2


def test_frames_with_a_window_are_read() -> None:
    data = "".join(NAMES).encode()
    frame = zstd_frames.frame(data)
    assert frame[4] == 0x60
    header = frame[:4] + b"\x80\x68" + len(data).to_bytes(4, "little")
    block = zstd_block(header + frame[7:], len(data))
    assert packed.unpacked(block, 0, len(data)) == (data, len(block))


@given(st.binary(max_size=60), st.integers(0, 400))
def test_any_frame_is_read_or_refused(end: bytes, at: int) -> None:
    data = "".join(NAMES[:200]).encode()
    frame = zstd_frames.frame(data)
    wrong = frame[:at] + end + frame[at + len(end) :]
    with suppress(FormatError):
        found, _ = packed.unpacked(zstd_block(wrong, len(data)), 0, len(data))
        assert len(found) == len(data)


def test_a_bomb_takes_no_more_than_it_says() -> None:
    bomb = zstd_frames.frame(bytes(1 << 26))
    lying = bomb[:6] + (65536).to_bytes(4, "little") + bomb[10:]
    tracemalloc.start()
    for frame in (bomb, lying):
        with pytest.raises(FormatError, match="invalid zstandard frame"):
            packed.unpacked(zstd_block(frame, 65536), 0, 65536)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 1 << 20
