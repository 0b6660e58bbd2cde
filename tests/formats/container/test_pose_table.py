"""Table of the poses of a file: what is written is read, and what nobody writes is refused."""

from __future__ import annotations

import math

import pytest

from deltamesh_formats.container.listing import pose_lines, poses_object
from deltamesh_formats.container.pose_table import (
    PoseEntry,
    pose_fault,
    read_poses,
    write_poses,
)
from deltamesh_formats.errors import FormatError, MeshError

ENTRIES = (PoseEntry("bent", 0.5, 11, b"abc"), PoseEntry("gebückt ✓", 1e-300, 0, b""))


def test_what_is_written_is_read() -> None:
    payload = write_poses(ENTRIES)
    found = read_poses(memoryview(payload))
    assert [(e.name, e.step, e.octaves, bytes(e.stream)) for e in found] == [
        (e.name, e.step, e.octaves, e.stream) for e in ENTRIES
    ]
    for entry in found:
        assert payload[entry.offset : entry.offset + len(entry.stream)] == bytes(entry.stream)
    assert sum(entry.size for entry in found) == len(payload)


@pytest.mark.parametrize("end", range(len(write_poses(ENTRIES))))
def test_what_is_cut_is_refused_or_has_fewer(end: int) -> None:
    payload = write_poses(ENTRIES)[:end]
    if end == ENTRIES[0].size:
        assert len(read_poses(memoryview(payload))) == 1
        return
    with pytest.raises(FormatError, match="truncated") as caught:
        read_poses(memoryview(payload))
    assert caught.value.offset == end


def test_a_name_comes_once() -> None:
    payload = write_poses((ENTRIES[0], ENTRIES[1], ENTRIES[0]))
    with pytest.raises(FormatError, match="pose 'bent' comes a second time") as caught:
        read_poses(memoryview(payload))
    assert caught.value.offset == ENTRIES[0].size + ENTRIES[1].size


@pytest.mark.parametrize(
    ("name", "step", "octaves", "field"),
    [
        ("", 1.0, 1, "name"),
        ("a\n", 1.0, 1, "name"),
        ("a\x1b[1m", 1.0, 1, "name"),
        ("a", 0.0, 1, "step"),
        ("a", -1.0, 1, "step"),
        ("a", math.inf, 1, "step"),
        ("a", math.nan, 1, "step"),
        ("a", 1.0, 25, "octaves"),
    ],
)
def test_what_no_pose_has_is_refused(name: str, step: float, octaves: int, field: str) -> None:
    fault = pose_fault(name, step, octaves)
    assert fault is not None
    assert fault[0] == field
    with pytest.raises(FormatError):
        read_poses(memoryview(write_poses([PoseEntry(name, step, octaves, b"")])))


def test_a_name_that_a_field_does_not_hold_is_refused() -> None:
    assert pose_fault("a" * 255, 1.0, 24) is None
    with pytest.raises(MeshError, match="255"):
        write_poses([PoseEntry("é" * 128, 1.0, 24, b"")])


def test_poses_are_listed() -> None:
    many = [PoseEntry(f"pose\t{i}", 0.5, 3, b"") for i in range(8)]
    (line,) = pose_lines(many)
    assert line.startswith('poses (8): "pose\\t0" 17 bytes, ')
    assert line.endswith("and 2 more")
    assert list(pose_lines([])) == []
    assert poses_object(ENTRIES)[0] == {"name": "bent", "step": 0.5, "bytes": ENTRIES[0].size}
