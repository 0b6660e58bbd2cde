"""Half-edges of faces, and the welding of vertices at one position.

Half-edge 3 f + i runs from corner i of triangle f to the next corner; with k corners a face, it is
k f + i.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.mesh import halfedges as kernels
from deltamesh_formats.array_types import Floats, Ints


def ends(faces: Ints) -> tuple[Ints, Ints]:
    """Return the vertices at which the half-edges of faces (m, k) start and end, int64 (k m,)."""
    return faces.ravel(), np.roll(faces, -1, axis=1).ravel()


def by_edge(start: Ints, end: Ints) -> tuple[Ints, Ints]:
    """Group half-edges by the undirected edge that they run along.

    Parameters
    ----------
    start, end : int64 (h,)
        Vertices, from 0.

    Returns
    -------
    order : int64 (h,)
        The half-edges, edge after edge in lexicographic order, ascending within an edge.
    bounds : int64 (e + 1,)
        Where each edge begins in that order, and the end of the last.
    """
    n = max(int(start.max(initial=-1)), int(end.max(initial=-1))) + 1
    return kernels.group_by_edge(start, end, n)


def edges_of_two(order: Ints, bounds: Ints) -> tuple[Ints, Ints]:
    """Return the half-edges of the edges that have exactly two, as `by_edge` groups them."""
    two = bounds[:-1][np.diff(bounds) == 2]
    return order[two], order[two + 1]


def pair_halfedges(faces: Ints) -> Ints:
    """Return the opposite of each half-edge of triangles (m, 3), int64 (3 m,), -1 where none is.

    Of an edge with more than two half-edges, the first two in the order of the faces are a pair.
    """
    order, bounds = by_edge(*ends(faces))
    first = bounds[:-1][np.diff(bounds) >= 2]
    opposite = np.full(faces.size, -1, dtype=np.int64)
    opposite[order[first]], opposite[order[first + 1]] = order[first + 1], order[first]
    return opposite


def weld(vertices: Floats, *, exact: bool = False) -> tuple[Ints, Ints]:
    """Find the vertices at exactly equal positions.

    Parameters
    ----------
    vertices : float64 (n, 3)
    exact : bool
        Positions are equal only bit for bit: -0.0 and 0.0 differ.

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
