"""Welding, and the closed oriented manifold on which the connectivity coder works.

A boundary loop is closed by a fan of faces around an added vertex (Touma & Gotsman, *Triangle
Mesh Compression*, 1998, section 3), so that the coder knows closed meshes only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.topology import first_split_vertex
from deltamesh_formats.errors import MeshError


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


def build_topology(
    faces: NDArray[np.int64], vertex_count: int, names: NDArray[np.int64]
) -> Topology:
    """Pair the half-edges, close the boundary loops and check that the mesh is a manifold.

    This is where a later version cuts a mesh into a manifold instead of refusing it.

    Parameters
    ----------
    faces : int64 (m, 3), welded
    vertex_count : int
    names : int64 (vertex_count,)
        What to call each vertex in a message: its index in the user's mesh.

    Raises
    ------
    MeshError
        For the first degenerate or duplicate face, edge with more than two faces, edge whose two
        faces disagree in winding, or vertex with more than one fan of faces.
    """
    _refuse_degenerate(faces, names)
    _refuse_edges(faces, vertex_count, names)
    opposite = pair_halfedges(faces, vertex_count)
    closing, loops = _close(faces, opposite, vertex_count, names)
    closed = np.concatenate([faces, closing])
    if loops:
        opposite = pair_halfedges(closed, vertex_count + loops)
    valence = np.bincount(closed.ravel(), minlength=vertex_count + loops)
    split = first_split_vertex(closed, opposite, valence)
    if split >= 0:
        name = names[split] if split < vertex_count else "on a boundary"
        raise MeshError(f"vertex {name} is not manifold: its faces form more than one fan")
    return Topology(closed, opposite, valence, len(faces), vertex_count)


def _refuse_degenerate(F: NDArray[np.int64], names: NDArray[np.int64]) -> None:
    bad = (F[:, 0] == F[:, 1]) | (F[:, 1] == F[:, 2]) | (F[:, 2] == F[:, 0])
    if bad.any():
        i = int(np.argmax(bad))
        raise MeshError(f"face {i} is degenerate: two of its corners are at one position")


def pair_halfedges(faces: NDArray[np.int64], n: int) -> NDArray[np.int64]:
    """Return the opposite of each half-edge, int64 (3 m,), -1 where it has none.

    Of an edge with more than two half-edges, the first two in the order of the faces are a pair.
    """
    order, same = _sorted_edges(faces, n)
    first = np.flatnonzero(same & ~np.concatenate(([False], same[:-1])))
    opposite = np.full(3 * len(faces), -1, dtype=np.int64)
    opposite[order[first]], opposite[order[first + 1]] = order[first + 1], order[first]
    return opposite


def _sorted_edges(F: NDArray[np.int64], n: int) -> tuple[NDArray[np.int64], NDArray[np.bool_]]:
    """Return the half-edges by edge, and whether each is on the edge of the next in that order."""
    start, end = F.ravel(), np.roll(F, -1, axis=1).ravel()
    key = np.minimum(start, end) * n + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    key = key[order]
    return order, key[1:] == key[:-1]


def _refuse_edges(F: NDArray[np.int64], n: int, names: NDArray[np.int64]) -> None:
    """Refuse edges with three faces or more, then faces that run along an edge the same way."""
    order, same = _sorted_edges(F, n)
    start, end = F.ravel(), np.roll(F, -1, axis=1).ravel()
    triple = same[1:] & same[:-1]
    if triple.any():
        h = order[np.flatnonzero(triple) + 2].min()
        edge = f"{names[start[h]]}-{names[end[h]]}"
        raise MeshError(f"edge {edge} is not manifold: face {h // 3} is at least its third")
    first, second = order[:-1][same], order[1:][same]
    twisted = start[first] == start[second]
    if twisted.any():
        i = np.argmin(np.where(twisted, second, np.iinfo(np.int64).max))
        edge = f"{names[start[first[i]]]}-{names[end[first[i]]]}"
        raise MeshError(
            f"faces {first[i] // 3} and {second[i] // 3} disagree in winding along edge {edge}"
        )


def _close(
    F: NDArray[np.int64], opposite: NDArray[np.int64], n: int, names: NDArray[np.int64]
) -> tuple[NDArray[np.int64], int]:
    """Return the faces that close the boundary loops, and the number of loops."""
    border = np.flatnonzero(opposite < 0)
    start, end = F.ravel()[border], np.roll(F, -1, axis=1).ravel()[border]
    count = np.bincount(start, minlength=n)
    if len(border) and count.max() > 1:
        v = int(np.argmax(count > 1))
        raise MeshError(f"vertex {names[v]} is not manifold: it is on a boundary more than once")
    successor = np.full(n, -1, dtype=np.int64)
    successor[start] = end
    loop = _loop_labels(successor, start)
    closing = np.stack([end, start, n + loop], axis=1)
    return closing, int(loop.max()) + 1 if len(loop) else 0


def _loop_labels(successor: NDArray[np.int64], start: NDArray[np.int64]) -> NDArray[np.int64]:
    """Label each boundary edge with its loop, by doubling: log2(edges) rounds, no Python loop."""
    lowest = np.arange(len(successor))
    jump = successor.copy()
    for _ in range(max(len(start), 1).bit_length()):
        lowest[start] = np.minimum(lowest[start], lowest[jump[start]])
        jump[start] = jump[jump[start]]
    return np.unique(lowest[start], return_inverse=True)[1].astype(np.int64)
