"""Welding, and the closed oriented manifold on which the connectivity coder works.

A boundary loop is closed by a fan of faces around an added vertex (Touma & Gotsman, *Triangle
Mesh Compression*, 1998, section 3), so that the coder knows closed meshes only.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

NO_QUADS: Final = np.zeros((0, 4), dtype=np.int64)


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
        Neighbours of the n vertices (0: isolated), then of the l vertices that close a loop.
    face_count, vertex_count : int
        m and n.
    """

    faces: NDArray[np.int64]
    opposite: NDArray[np.int64]
    valence: NDArray[np.int64]
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


def weld(
    vertices: NDArray[np.float64], *, exact: bool = False
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Find the vertices at exactly equal positions.

    Parameters
    ----------
    vertices : float64 (n, 3)
    exact : bool
        Tell -0.0 from 0.0: positions are equal only bit for bit.

    Returns
    -------
    keep : int64 (w,)
        The first vertex at each position, ascending.
    welded : int64 (n,)
        For each vertex, its index among `keep`.
    """
    keys = vertices.view(np.int64) if exact else vertices
    order = np.lexsort(keys.T)  # unless exact, -0.0 and 0.0 are equal here, as they are below
    new = np.ones(len(vertices), dtype=bool)
    new[1:] = (keys[order[1:]] != keys[order[:-1]]).any(axis=1)
    group = np.cumsum(new) - 1
    # lexsort is stable: the first of a group is its lowest index.
    first = order[new]
    rank = np.empty(len(first), dtype=np.int64)
    rank[np.argsort(first)] = np.arange(len(first))
    welded = np.empty(len(vertices), dtype=np.int64)
    welded[order] = rank[group]
    return np.sort(first), welded


def build_topology(faces: NDArray[np.int64], opposite: NDArray[np.int64], n: int) -> Topology:
    """Close the boundary loops of an oriented manifold.

    Parameters
    ----------
    faces : int64 (m, 3)
        With one fan of faces around each vertex, and no two edges between the same two vertices,
        as of `complexes.cut`.
    opposite : int64 (3 m,)
        As of `pair_halfedges`.
    n : int
        Number of vertices.
    """
    border = np.flatnonzero(opposite < 0)
    start, end = faces.ravel()[border], np.roll(faces, -1, axis=1).ravel()[border]
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


def pair_halfedges(faces: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Return the opposite of each half-edge, int64 (3 m,), -1 where it has none.

    Of an edge with more than two half-edges, the first two in the order of the faces are a pair.
    """
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    key = np.minimum(start, end) * n + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    same = key[order[1:]] == key[order[:-1]]
    first = np.flatnonzero(same & ~np.concatenate(([False], same[:-1])))
    opposite = np.full(3 * len(faces), -1, dtype=np.int64)
    opposite[order[first]], opposite[order[first + 1]] = order[first + 1], order[first]
    return opposite


def _loop_labels(successor: NDArray[np.int64], start: NDArray[np.int64]) -> NDArray[np.int64]:
    """Label each boundary edge with its loop, by doubling: log2(edges) rounds, no Python loop."""
    lowest = np.arange(len(successor))
    jump = successor.copy()
    for _ in range(max(len(start), 1).bit_length()):
        lowest[start] = np.minimum(lowest[start], lowest[jump[start]])
        jump[start] = jump[jump[start]]
    return np.unique(lowest[start], return_inverse=True)[1].astype(np.int64)


def parallelograms(
    faces: NDArray[np.int64], n: int, quads: NDArray[np.int64] = NO_QUADS
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Return, for each vertex, the parallelograms that predict it.

    Parameters
    ----------
    faces : int64 (m, 3), of an oriented manifold
    n : int
    quads : int64 (q, 4)
        The polygons of four corners among those that the faces make.

    Returns
    -------
    first : int64 (n + 1,)
    corners : int64 (p, 3)
        Rows first[i] to first[i + 1] are (a, b, o), all below i: first those where (a, i, b, o)
        is a quad, then those where (a, b, i) is a face, (b, a, o) another.
    within : int64 (n,)
        How many of those of each vertex are quads.
    """
    opposite = pair_halfedges(faces, n)
    a, b, apex = (
        faces.ravel(),
        np.roll(faces, -1, axis=1).ravel(),
        np.roll(faces, -2, axis=1).ravel(),
    )
    across = np.where(opposite >= 0, apex[opposite], n)
    sides = [np.roll(quads, -turn, axis=1).ravel() for turn in (3, 1, 2, 0)]
    a, b, across, apex = (
        np.concatenate(both) for both in zip(sides, (a, b, across, apex), strict=True)
    )
    known = np.flatnonzero(np.maximum(np.maximum(a, b), across) < apex)
    known = known[np.argsort(apex[known], kind="stable")]
    first = np.zeros(n + 1, dtype=np.int64)
    np.cumsum(np.bincount(apex[known], minlength=n), out=first[1:])
    within = np.bincount(apex[known[known < quads.size]], minlength=n)
    return first, np.stack([a[known], b[known], across[known]], axis=1), within
