"""Closed oriented manifold on which the connectivity coder works.

A boundary loop is closed by a fan of faces around an added vertex (Touma & Gotsman, *Triangle
Mesh Compression*, 1998, section 3), so that the coder knows closed meshes only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._graph.halfedges import ends
from deltamesh_formats.array_types import Ints


@dataclass(frozen=True)
class Topology:
    """A closed, consistently oriented 2-manifold.

    Attributes
    ----------
    faces : int64 (m + b, 3)
        The m faces of the mesh, then the b faces that close its boundary loops.
    opposite : int64 (3 (m + b),)
        The half-edge on the other side of each half-edge.
    valence : int64 (n + l,)
        Number of neighbours of each of the n vertices (0: isolated), then of the l vertices that
        close a loop.
    face_count, vertex_count : int
        m and n.
    """

    faces: Ints
    opposite: Ints
    valence: Ints
    face_count: int
    vertex_count: int

    @property
    def loop_count(self) -> int:
        """Number l of boundary loops."""
        return len(self.valence) - self.vertex_count

    @property
    def boundary_edge_count(self) -> int:
        """Number b of boundary edges."""
        return len(self.faces) - self.face_count


def build_topology(faces: Ints, opposite: Ints, n: int) -> Topology:
    """Close the boundary loops of an oriented manifold.

    Parameters
    ----------
    faces : int64 (m, 3)
        With one fan of faces around each vertex, and no two edges between the same two vertices,
        as `complexes.cut` returns them.
    opposite : int64 (3 m,)
        As `halfedges.pair_halfedges` returns it.
    n : int
        Number of vertices.
    """
    border = np.flatnonzero(opposite < 0)
    start, end = (vertices[border] for vertices in ends(faces))
    successor = np.full(n, -1, dtype=np.int64)
    successor[start] = end
    loop = _loop_labels(successor, start)
    loops = int(loop.max()) + 1 if len(loop) else 0
    # A face (end, start, loop vertex) for each; those of a loop meet at the edges to its vertex.
    closing = np.stack([end, start, n + loop], axis=1)
    across = np.full(3 * len(closing), -1, dtype=np.int64)
    first = 3 * (len(faces) + np.arange(len(border)))
    into = np.empty(n, dtype=np.int64)
    into[end] = first
    across[0::3], across[1::3] = border, into[start] + 2
    across[(into[start] - 3 * len(faces)) + 2] = first + 1
    opposite = np.concatenate([opposite, across])
    opposite[border] = first
    closed = np.concatenate([faces, closing])
    valence = np.bincount(closed.ravel(), minlength=n + loops)
    return Topology(closed, opposite, valence, len(faces), n)


def _loop_labels(successor: Ints, start: Ints) -> Ints:
    """Return the loop of each boundary edge, found by doubling in log2(edges) rounds."""
    lowest = np.arange(len(successor))
    jump = successor.copy()
    for _ in range(max(len(start), 1).bit_length()):
        lowest[start] = np.minimum(lowest[start], lowest[jump[start]])
        jump[start] = jump[jump[start]]
    return np.unique(lowest[start], return_inverse=True)[1].astype(np.int64)
