"""Graph distances, and the local maxima and updates of greedy anchors; `src/core/distance.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import (
    bools_out,
    call,
    floats,
    floats_out,
    graph,
    ints,
    ints_out,
    scratch,
)
from deltamesh_formats.array_types import Bools, Floats, Ints, Shorts


def farthest_points(indptr: Shorts, indices: Shorts, first: Ints, anchors: Ints) -> None:
    """Fill `anchors` (k,): the c points of `first`, then always the vertex farthest from them all.

    Every component has a point in `first`; c <= k <= n. Ties go to the lowest index.
    """
    n, c, k = len(indptr) - 1, len(first), len(anchors)
    points = ints(first, c), c, ints_out(anchors, k), k
    call("dm_farthest_points", *graph(indptr, indices, n), *points, scratch(n), scratch(n))


def nearest(indptr: Shorts, indices: Shorts, sources: Ints) -> Ints:
    """Return which of the sources is the fewest edges away from each vertex, int64 (n,); -1: none.

    Of equally near ones, a vertex takes that of the neighbour which a breadth-first search from all
    sources, in their order, comes to first.
    """
    n, count = len(indptr) - 1, len(sources)
    found = np.empty(n, dtype=np.int64)
    given = *graph(indptr, indices, n), ints(sources, count), count
    call("dm_nearest", *given, ints_out(found, n), scratch(n))
    return found


def local_maxima(indptr: Shorts, indices: Shorts, value: Floats, is_maximum: Bools) -> None:
    """Mark the vertices whose value no neighbour exceeds; of equal neighbours the lowest index."""
    n = len(indptr) - 1
    call("dm_local_maxima", *graph(indptr, indices, n), floats(value, n), bools_out(is_maximum, n))


def subtract_product(block: Floats, W: Floats, count: int, rows: Ints) -> None:
    """Do block -= W[:, :count] @ W[rows, :count].T in place, in a fixed order of operations."""
    (n, width), row = block.shape, W.shape[1]
    columns = np.empty((count, width))
    matrix = floats_out(block, n, width), n, width, floats(W, n, row), row, count
    call("dm_subtract_product", *matrix, ints(rows, width), floats_out(columns, count, width))
