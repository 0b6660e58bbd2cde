"""Sequences for tests: meshes that turn, twist and grow."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
from forging import forged

from deltamesh import encode, from_arrays, info
from deltamesh_formats.container.frame_table import frames_of, write_frames


def positions(V, count=4, each=0.2):
    """Of so many frames: a twist about z, a turn, and growth along z; shape (count, n, 3)."""
    frames = []
    for t in range(count):
        angle = each * t * (1 + 0.5 * V[:, 2])
        c, s = np.cos(angle), np.sin(angle)
        x, y = c * V[:, 0] - s * V[:, 1], s * V[:, 0] + c * V[:, 1]
        frames.append(np.stack((x, y, V[:, 2] * (1 + 0.1 * t)), axis=1))
    return np.stack(frames)


def moving(mesh, count=4, each=0.2):
    """The frames of vertices and faces, as meshes."""
    V, F = mesh
    return [from_arrays(frame, F) for frame in positions(V, count, each)]


# Frames and options, by the names of golden files.
MADE = {
    "refined-sequence": (moving(meshes.torus(7, 6), 4), {"fps": 25, "key_every": 2}),
    "highpass-sequence": (
        moving(meshes.with_isolated(), 3),
        {"bits": 8, "anchors": 4, "keep_order": True},
    ),
    "cartesian-sequence": (moving(meshes.two_components(), 2), {"bits": 9, "fps": 12.5}),
}


def file_of(name):
    frames, options = MADE[name]
    return encode(frames, method=name.split("-")[0], **options)


def with_frames(data, change, rate=None):
    """The file with the frames that `change` makes of its own, and their checksums right."""
    container = info(data)
    own, frames = frames_of(container)
    made = write_frames(own if rate is None else rate, change(frames), container.parameters.method)
    return forged(data, FRAM=made)


def with_first(data, **fields):
    """The file with other fields in frame 1."""
    return with_frames(data, lambda frames: [replace(frames[0], **fields), *frames[1:]])
