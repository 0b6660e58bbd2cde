"""Section of the poses: both directions, and the digest that covers it."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest

from deltamesh import encode
from deltamesh._geometry.poses import Pose
from deltamesh._pipeline.decoder import read_content
from deltamesh._sections import poses
from deltamesh_formats.container.pose_table import PoseEntry, write_poses
from deltamesh_formats.container.reader import read_container
from deltamesh_formats.errors import FormatError

CONTAINER = read_container(encode(*meshes.torus(9, 7), method="highpass", bits=7, anchors=8))
CONTENT = read_content(CONTAINER, 1 << 30, 1 << 40)
NUMBERS = np.random.default_rng(3).integers(-9, 10, size=(8, 6))
POSED = replace(CONTENT, poses=(Pose("a", 0.5, 10, NUMBERS), Pose("b", 0.25, 9, -NUMBERS)))


def test_what_is_coded_comes_back() -> None:
    found = poses.decode(memoryview(poses.encode(POSED)), CONTAINER, CONTENT)
    assert [pose.name for pose in found.poses] == ["a", "b"]
    for own, other in zip(found.poses, POSED.poses, strict=True):
        np.testing.assert_array_equal(own.numbers, other.numbers)
    assert found.digest() == POSED.digest()


def test_the_digest_covers_names_steps_units_and_numbers() -> None:
    first, second = POSED.poses
    others = [
        (second, first),
        (first,),
        (replace(first, name="c"), second),
        (replace(first, step=0.75), second),
        (replace(first, octaves=11), second),
        (replace(first, numbers=NUMBERS + 1), second),
    ]
    digests = {replace(CONTENT, poses=one).digest() for one in (*others, POSED.poses, ())}
    assert len(digests) == len(others) + 2
    assert CONTENT.digest() in digests


def test_displacements_that_are_too_large_are_refused() -> None:
    assert poses.has_scale(Pose("a", 1e149, 1, np.ones((8, 6), dtype=np.int64)))
    large = Pose("a", 1e151, 1, np.ones((8, 6), dtype=np.int64))
    assert not poses.has_scale(large)
    payload = poses.encode(replace(CONTENT, poses=(large,)))
    with pytest.raises(FormatError, match="too large"):
        poses.decode(memoryview(payload), CONTAINER, CONTENT)


def test_a_stream_of_other_motions_is_refused() -> None:
    payload = write_poses([PoseEntry("a", 1.0, 3, b"\1\2\3" * 20)])
    with pytest.raises(FormatError):
        poses.decode(memoryview(payload), CONTAINER, CONTENT)
