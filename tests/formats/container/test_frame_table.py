"""The table of the frames: mirrors, and bytes that no writer makes."""

from __future__ import annotations

from dataclasses import replace

import animated
import pytest

from deltamesh import info
from deltamesh_formats.container.frame_table import Frame, frames_of, read_frames, write_frames
from deltamesh_formats.errors import FormatError

DATA = animated.file_of("refined-sequence")
CONTAINER = info(DATA)
SECTION = CONTAINER.sections["FRAM"]


def read(payload: bytes) -> tuple[float, tuple[Frame, ...]]:
    view, start = memoryview(payload), SECTION.start
    return read_frames(view, start, CONTAINER.parameters, CONTAINER.vertices)


def test_the_writer_is_the_mirror_of_the_reader() -> None:
    rate, frames = frames_of(CONTAINER)
    assert (rate, CONTAINER.fps, CONTAINER.frame_count) == (25.0, 25.0, 4)
    assert [frame.is_key for frame in frames] == [False, True, False]
    assert write_frames(rate, frames, "refined") == bytes(SECTION.payload)
    for frame in frames:
        record = DATA[frame.offset : frame.offset + frame.size]
        for section in frame.sections.values():
            assert DATA[section.start :][: len(section.payload)] == bytes(section.payload)
            assert frame.offset < section.start <= frame.offset + len(record)
    assert frames[-1].offset + frames[-1].size == SECTION.end - 4


def test_a_file_of_one_mesh_has_no_further_frames() -> None:
    from deltamesh import encode

    one = info(encode(animated.MADE["refined-sequence"][0][0], step=0.1, method="refined"))
    assert (one.frames, one.fps, one.frame_count) == ((), None, 1)


def test_every_payload_that_is_cut_is_refused() -> None:
    payload = bytes(SECTION.payload)
    for size in range(len(payload)):
        with pytest.raises(FormatError) as caught:
            read(payload[:size])
        assert caught.value.offset is not None
        assert caught.value.offset <= len(payload)


def test_every_byte_that_is_changed_is_refused_but_the_rate() -> None:
    """A checksum covers each record; sizes and the count contradict it."""
    payload = bytearray(SECTION.payload)
    for at in range(8, len(payload)):
        payload[at] ^= 0x10
        with pytest.raises(FormatError):
            read(bytes(payload))
        payload[at] ^= 0x10


def test_a_run_of_frames_ends_with_a_key_frame() -> None:
    rate, frames = frames_of(CONTAINER)
    long = [replace(frames[0], is_key=False)] * 256
    with pytest.raises(FormatError, match="frame 256: more than 255 frames since a key frame"):
        read(write_frames(rate, long, "refined"))
    long[128] = replace(long[0], is_key=True)
    assert len(read(write_frames(rate, long, "refined"))[1]) == 256
