"""Poses: other positions of a surface, from motions of its anchors (section POSE).

A file keeps its connectivity, deltas and anchors; a pose adds, for each anchor, how far it is
displaced and how it is turned. Where these are known, two linear systems make the surface: the
first spreads the rotations, as the second does the positions, of deltas that have turned.

Source: Y. Lipman, O. Sorkine, D. Levin, D. Cohen-Or, "Linear rotation-invariant coordinates for
meshes", SIGGRAPH 2005. Frames there are those of the tangent planes; here they are relative to the
surface at rest, so that the first system has the matrix of the second, and its right-hand side is
zero. Quaternions take the place of matrices: four columns, not nine, and rotations of far anchors
may differ by any angle.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._geometry import rotations
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.solve import LeastSquares
from deltamesh._graph.adjacency import Graph, adjacency_between
from deltamesh._kernels.mesh import motions
from deltamesh._streams.vectors import decode_vectors, encode_vectors
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.pose_table import PoseEntry
from deltamesh_formats.errors import MeshError

# Weight of the anchors of a pose against the turned deltas: the surface goes through them within a
# tenth of the step of a record, and errors between them are those of weight 1.
WEIGHT = 10.0
# Numbers that the residual coder takes are below 2^31.
MOST = float((1 << 31) - 1)


@dataclass(frozen=True)
class Pose:
    """Motions of the anchors of a file, exactly as they are entropy-coded.

    Attributes
    ----------
    name : str
    step : float
        Of displacements, in the unit of the mesh.
    octaves : int
        The unit of rotations is 2^-octaves.
    numbers : int64 (k, 6)
        Of each anchor, how far it is from where the motion of its parent takes it, in steps; and
        tan(angle / 4) along the axis of what it turns further, in units.
    """

    name: str
    step: float
    octaves: int
    numbers: Ints

    @property
    def unit(self) -> float:
        """The unit of rotations."""
        return 2.0**-self.octaves

    def arrays(self) -> tuple[Ints, ...]:
        """Return the arrays that the digest of a file covers."""
        name = np.frombuffer(self.name.encode(), dtype=np.uint8).astype(np.int64)
        fields = np.array([np.float64(self.step).view(np.int64), self.octaves])
        return name, fields, self.numbers


@dataclass(frozen=True)
class Tree:
    """Anchors as nodes of trees, one a component, in which neighbours have the longest borders.

    Attributes
    ----------
    order : int64 (k,)
        The anchors as they are coded, parents first.
    parent : int64 (k,)
        Of each anchor, -1 for the first of a component.
    graph : pair of int32 arrays (2 k + 1,), (e,)
        What predicts how large the numbers of a motion are: displacements, in the order of the
        anchors, and then rotations, have those of neighbouring cells, and each other, for
        neighbours.
    """

    order: Ints
    parent: Ints
    graph: Graph


def tree_of(cells: Cells) -> Tree:
    """Return the tree of the anchors of cells, a function of connectivity and anchors."""
    k = len(cells.anchors)
    low, high, length = _borders(cells)
    by_length = np.lexsort((high, low, -length))
    kept = by_length[motions.span(low[by_length], high[by_length], k)]
    order, parent = motions.walk(*adjacency_between(low[kept], high[kept], k))
    rank = np.empty(k, dtype=np.int64)
    rank[order] = np.arange(k)
    a, b, each = rank[low], rank[high], np.arange(k)
    graph = adjacency_between(
        np.concatenate((a, a + k, each)), np.concatenate((b, b + k, each + k)), 2 * k
    )
    return Tree(order, parent, graph)


def _borders(cells: Cells) -> tuple[Ints, Ints, Ints]:
    """Return the pairs of cells that edges join, the lower one first, and how many edges do."""
    tail, head = cells.borders
    ascending = tail < head
    pairs, length = np.unique(
        tail[ascending] * len(cells.anchors) + head[ascending], return_counts=True
    )
    return pairs // len(cells.anchors), pairs % len(cells.anchors), length.astype(np.int64)


def measured(
    name: str,
    step: float,
    octaves: int,
    tree: Tree,
    rest: Floats,
    positions: Floats,
    quaternions: Floats,
) -> Pose:
    """Return the pose that comes nearest to positions and rotations of anchors.

    Parameters
    ----------
    name, step, octaves
        See `Pose`.
    tree : Tree
    rest, positions : float64 (k, 3)
        Of the anchors, at rest and in the pose.
    quaternions : float64 (k, 4)
        Of either sign.

    Raises
    ------
    MeshError
        If an anchor moves by 2^30 steps or more.
    """
    moved = float(np.abs(positions - rest).max(initial=0.0))
    extent = float(np.ptp(rest, axis=0).max(initial=0.0))
    if not 4 * (moved + extent) < MOST / 2 * step:
        raise MeshError(f"anchors of pose {name!r} move by too many steps of {step:g}")
    numbers = motions.measure(
        tree.order, tree.parent, rest, step, 2.0**-octaves, positions, quaternions
    )
    return Pose(name, step, octaves, numbers)


def posed(
    graph: Graph, vertices: Floats, system: LeastSquares, anchors: Ints, tree: Tree, pose: Pose
) -> tuple[Floats, Floats]:
    """Return a surface in a pose.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
    vertices : float64 (n, 3)
        At rest.
    system : LeastSquares
        Of the graph and the anchors, with `WEIGHT`.
    anchors : int64 (k,)
    tree : Tree
    pose : Pose

    Returns
    -------
    float64 (n, 3), (n, 3, 3)
        Positions, and how the neighbourhood of each vertex has turned.

    Raises
    ------
    SolveError
    """
    rest = vertices[anchors]
    positions, quaternions = motions.carry(
        tree.order, tree.parent, rest, pose.step, pose.unit, pose.numbers
    )
    return two_systems(graph, vertices, system, positions, quaternions)


def two_systems(
    graph: Graph, vertices: Floats, system: LeastSquares, positions: Floats, quaternions: Floats
) -> tuple[Floats, Floats]:
    """Return positions and rotations, as `posed` does, for those of the anchors of a system."""
    spread = system.solve(np.zeros((len(vertices), 4)), quaternions)
    turns = rotations.of_quaternions(spread)
    deltas = rotations.turned_deltas(graph, vertices, turns)
    return system.solve(deltas, positions), turns


def encode_pose(pose: Pose, tree: Tree) -> PoseEntry:
    """Return a pose as the table of POSE has it."""
    rows = np.concatenate((pose.numbers[tree.order, :3], pose.numbers[tree.order, 3:]))
    return PoseEntry(pose.name, pose.step, pose.octaves, encode_vectors(*tree.graph, rows))


def decode_pose(entry: PoseEntry, tree: Tree) -> Pose:
    """Return the pose of an entry: the mirror of `encode_pose`.

    Raises
    ------
    FormatError
        If its stream does not end where it should.
    """
    rows = decode_vectors(*tree.graph, bytes(entry.stream), entry.offset)
    k = len(tree.order)
    numbers = np.empty((k, 6), dtype=np.int64)
    numbers[tree.order] = np.concatenate((rows[:k], rows[k:]), axis=1)
    return Pose(entry.name, entry.step, entry.octaves, numbers)
