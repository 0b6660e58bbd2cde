"""Half-edges of triangles, and the welding of vertices at one position.

Half-edge 3 f + i runs from corner i of face f to the next corner.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


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
