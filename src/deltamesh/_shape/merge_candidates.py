"""Half-edges across which triangles may be merged into polygons, and those across which they are.

A polygon of k corners is k - 2 triangles, merged across k - 3 edges, which are hidden then.
"""

from __future__ import annotations

import numpy as np

from deltamesh._graph.halfedges import ends
from deltamesh_formats.array_types import Bools, Ints, Shorts
from deltamesh_formats.polymesh.triangles import Triangles


def merged_halfedges(triangles: Triangles, corners: Shorts) -> Ints:
    """Return the half-edge that each half-edge is merged with, int64 (3 m,), -1 for none.

    Parameters
    ----------
    triangles : Triangles
        Of the input, fans.
    corners : int32 (m, 3)
        The corner of these, 3 * triangle + 0, 1 or 2, at each corner of the triangles of the file.
    """
    halfedge = np.empty(corners.size, dtype=np.int64)
    halfedge[corners.ravel()] = np.arange(corners.size)
    same = np.flatnonzero(triangles.polygon[1:] == triangles.polygon[:-1])
    # In a fan around a, the edge from i + 1 to a, and that from a to i + 1 of the next triangle.
    one, other = halfedge[3 * same + 2], halfedge[3 * same + 3]
    merged = np.full(corners.size, -1, dtype=np.int64)
    merged[one], merged[other] = other, one
    return merged


def merge_candidates(faces: Ints, opposite: Ints, reversed_: Bools) -> Ints:
    """Return the half-edge that each half-edge may be merged with, int64 (3 m,), -1 for none.

    That is its opposite in the manifold, where it runs between the same two vertices, the other
    way, in the mesh, too. Of the others, on each edge, the first that runs from its lower to its
    higher vertex is with the first that runs back, the second with the second, and so on.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the mesh; first those of the manifold.
    opposite : int64 (3 k,)
        Of the half-edges of the manifold.
    reversed_ : bool (k,)
        Whether the mesh has a face with the other winding.
    """
    start, end = ends(faces)
    candidate = np.full(len(start), -1, dtype=np.int64)
    h = np.flatnonzero(opposite >= 0)
    one, other = _of_mesh(h, reversed_), _of_mesh(opposite[h], reversed_)
    fit = (start[one] == end[other]) & (end[one] == start[other])
    candidate[one[fit]] = other[fit]

    rest = np.flatnonzero((candidate < 0) & (start != end))
    if not len(rest):
        return candidate
    low, high = np.minimum(start, end)[rest], np.maximum(start, end)[rest]
    back = start[rest] > end[rest]
    order = np.lexsort((rest, back, high, low))
    low, high, back, rest = low[order], high[order], back[order], rest[order]
    new = np.flatnonzero((low[1:] != low[:-1]) | (high[1:] != high[:-1])) + 1
    first, size = np.concatenate(([0], new)), np.diff(np.concatenate(([0], new, [len(rest)])))
    forward = size - np.add.reduceat(back.astype(np.int64), first)
    pairs = np.minimum(forward, size - forward)
    rank = np.arange(pairs.sum()) - np.repeat(np.cumsum(pairs) - pairs, pairs)
    first, forward = np.repeat(first, pairs), np.repeat(forward, pairs)
    one, other = rest[first + rank], rest[first + forward + rank]
    candidate[one], candidate[other] = other, one
    return candidate


def hidden_halfedges(merged: Ints, opposite: Ints, reversed_: Bools) -> Bools:
    """Return which half-edges of the manifold are merged with their opposites, bool (3 k,)."""
    h = np.arange(len(opposite))
    other = np.where(opposite >= 0, _of_mesh(opposite, reversed_), -2)
    return np.asarray(merged[_of_mesh(h, reversed_)] == other)


def _of_mesh(halfedges: Ints, reversed_: Bools) -> Ints:
    """Return half-edges of the manifold as half-edges of the mesh, or the other way round."""
    face, side = np.divmod(halfedges, 3)
    return 3 * face + np.where(reversed_[face], 2 - side, side)
