"""Section of the poses: a name, steps and a stream of motions for each."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh._content import Content
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.poses import Pose, Tree, decode_pose, encode_pose, tree_of
from deltamesh._mesh import LARGEST
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.pose_table import read_poses, write_poses
from deltamesh_formats.errors import FormatError


def tree_of_anchors(content: Content) -> Tree:
    """Return the tree along which the motions of a file are coded."""
    surface = content.structure.surface
    return tree_of(Cells(surface.graph, surface.labels, content.integers.anchors))


def encode(content: Content) -> bytes:
    """Return the payload of POSE for the poses of a content."""
    tree = tree_of_anchors(content)
    return write_poses(encode_pose(pose, tree) for pose in content.poses)


def decode(payload: memoryview, container: Container, content: Content) -> Content:
    """Return the content with its poses: the mirror of `encode`.

    Raises
    ------
    FormatError
    """
    tree = tree_of_anchors(content)
    poses = []
    for entry in read_poses(payload):
        pose = decode_pose(entry, tree)
        if not has_scale(pose):
            message = f"pose {pose.name!r}: displacements that are too large"
            raise FormatError(message, entry.offset)
        poses.append(pose)
    return replace(content, poses=tuple(poses))


def has_scale(pose: Pose) -> bool:
    """Return whether all displacements together would not overflow (SPEC.md 5.8)."""
    total = float(np.abs(pose.numbers[:, :3]).astype(np.float64).sum())
    return bool(total * pose.step <= 100 * LARGEST)
