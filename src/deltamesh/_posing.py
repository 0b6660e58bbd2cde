"""Poses of a decoded file: which there are, and the mesh in one of them."""

from __future__ import annotations

import numpy as np

from deltamesh._attributes.turned import posed_mesh
from deltamesh._content import Content
from deltamesh._geometry.poses import WEIGHT, Pose, posed
from deltamesh._geometry.solve import LeastSquares
from deltamesh._sections.poses import tree_of_anchors
from deltamesh_formats.array_types import Floats
from deltamesh_formats.container.container import Container
from deltamesh_formats.container.pose_table import entries_of
from deltamesh_formats.errors import OptionError
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.printing import shortened


def check_name(container: Container, name: str) -> None:
    """Refuse a pose that a file does not have.

    Raises
    ------
    OptionError
        It has the names of those that there are.
    FormatError
    """
    names = [entry.name for entry in entries_of(container)]
    if name not in names:
        known = ", ".join(map(repr, names))
        there = f"the poses are {shortened(known, 200)}" if names else "the file has none"
        raise OptionError(f"there is no pose {name!r}: {there}")


def pose_named(content: Content, name: str) -> Pose:
    """Return the pose of a name that there is."""
    return next(pose for pose in content.poses if pose.name == name)


def posing_system(
    content: Content, solver: str, threads: int | None, memory: float
) -> LeastSquares:
    """Return the system from which the poses of a file are solved.

    Raises
    ------
    LimitError, SolveError
    """
    graph, anchors = content.structure.surface.graph, content.integers.anchors
    return LeastSquares(graph, anchors, solver, threads, memory, WEIGHT)


def posed_points(
    content: Content, points: Floats, system: LeastSquares, pose: Pose
) -> tuple[Floats, Floats]:
    """Return points in a pose, float64 (p, 3), and how each has turned, float64 (p, 3, 3).

    Isolated ones stay.
    """
    surface, anchors = content.structure.surface, content.integers.anchors
    n = surface.vertex_count
    tree = tree_of_anchors(content)
    moved, turns = posed(surface.graph, points[:n], system, anchors, tree, pose)
    return with_isolated(points, moved, turns)


def with_isolated(points: Floats, moved: Floats, turns: Floats) -> tuple[Floats, Floats]:
    """Return the results for the points of faces with those of the others, which stay."""
    rest = points[len(moved) :]
    still = np.broadcast_to(np.eye(3), (len(rest), 3, 3))
    return np.concatenate((moved, rest)), np.concatenate((turns, still))


def in_pose(mesh: PolyMesh, content: Content, points: Floats, turns: Floats) -> PolyMesh:
    """Return the mesh of a file with other positions of its points, turned by matrices."""
    return posed_mesh(mesh, points[content.points], turns[content.points])
