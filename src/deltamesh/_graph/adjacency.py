"""Edges of a mesh, neighbours of its vertices, and connected components."""

from __future__ import annotations

from typing import Final, TypeAlias

import numpy as np

from deltamesh._graph.halfedges import ends
from deltamesh._kernels.mesh import neighbours
from deltamesh_formats.array_types import Ints, Shorts
from deltamesh_formats.errors import LimitError
from deltamesh_formats.polymesh.permutations import numbered

# Neighbour lists: indptr and indices, see `adjacency`.
Graph: TypeAlias = tuple[Shorts, Shorts]
# Half-edges, and vertices, that 32 bits can count: an entry for each end.
MOST: Final = (1 << 30) - 1


def edges(faces: Ints, n: int) -> Ints:
    """Return the undirected edges, each once whatever the number of faces on it.

    Parameters
    ----------
    faces : int64 (m, 3)
        Vertex indices in [0, n). A face that repeats a vertex contributes no loop.
    n : int
        Number of vertices, below 2**31.

    Returns
    -------
    int64 (e, 2)
        Pairs (i, j), i < j, in lexicographic order.
    """
    indptr, indices = adjacency(faces, n)
    rows = np.repeat(np.arange(n), np.diff(indptr))
    ascending = rows < indices
    return np.stack([rows[ascending], indices[ascending]], axis=1)


def adjacency(faces: Ints, n: int) -> Graph:
    """Return the neighbours of every vertex.

    Parameters
    ----------
    faces : int64 (m, 3)
    n : int

    Returns
    -------
    indptr : int32 (n + 1,)
    indices : int32 (2 e,)
        The neighbours of i are `indices[indptr[i]:indptr[i + 1]]`, ascending.

    Raises
    ------
    LimitError
        If 32 bits cannot count them.
    """
    return adjacency_between(*ends(faces), n)


def adjacency_between(a: Ints, b: Ints, n: int) -> Graph:
    """Return the neighbours of every vertex along half-edges from a to b, int64 (h,)."""
    if max(len(a), n) > MOST:
        raise LimitError(f"{len(a)} half-edges of {n} vertices are too many for 32 bits")
    return neighbours.gather(a, b, n)


def components(indptr: Shorts, indices: Shorts) -> Ints:
    """Return the connected component of every vertex.

    Parameters
    ----------
    indptr, indices : int32 (n + 1,), (2 e,)
        Neighbour lists, from `adjacency`.

    Returns
    -------
    int64 (n,)
        Labels 0, 1, ... in the order of each component's lowest vertex. An isolated vertex is a
        component of its own.
    """
    labels = np.empty(len(indptr) - 1, dtype=np.int64)
    neighbours.label_components(indptr, indices, labels)
    return labels


def components_of_faces(faces: Ints, n: int) -> Ints:
    """Return the connected component of every vertex, int64 (n,), -1 for one in no face."""
    labels = components(*adjacency(faces, n))
    in_face = np.zeros(n, dtype=bool)
    in_face[faces] = True
    labels[in_face], labels[~in_face] = numbered(labels[in_face])[0], -1
    return labels


def lowest(labels: Ints) -> Ints:
    """Return the lowest vertex of each component, in the order of the labels of `components`."""
    return np.unique(labels, return_index=True)[1].astype(np.int64)
