"""Graph distances, and the local maxima and updates of greedy anchors."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.jit import kernel
from deltamesh_formats.array_types import Bools, Floats, Ints


@kernel
def relax(indptr: Ints, indices: Ints, source: int, distance: Ints, queue: Ints) -> None:
    """Lower `distance` (n,) in place to the distance from a new source, where that is less.

    A breadth-first search that goes on from the vertices it lowers only: where the new source is
    not nearer, neither is it beyond. A vertex enters the queue once, since the first distance that
    the search gives it is the final one; `queue` (n,) is scratch.
    """
    distance[source] = 0
    queue[0] = source
    head, tail = 0, 1
    while head < tail:
        v = queue[head]
        head += 1
        for at in range(indptr[v], indptr[v + 1]):
            w = indices[at]
            if distance[w] > distance[v] + 1:
                distance[w] = distance[v] + 1
                queue[tail] = w
                tail += 1


@kernel
def farthest_points(indptr: Ints, indices: Ints, first: Ints, anchors: Ints) -> None:
    """Fill `anchors` (k,): the c points of `first`, then always the vertex farthest from them all.

    Every component has a point in `first`; c <= k <= n. Ties go to the lowest index. Distances only
    fall, so the vertices at the present maximum are taken in one ascending scan: a vertex joins
    that level never, and has left it if its distance is less by the time the scan comes to it.
    """
    n, k = len(indptr) - 1, len(anchors)
    distance = np.full(n, n, np.int64)
    queue = np.empty(n, np.int64)
    count = 0
    for source in first:
        anchors[count] = source
        count += 1
        relax(indptr, indices, source, distance, queue)
    while count < k:
        level = np.int64(0)
        for v in range(n):
            level = max(level, distance[v])
        for v in range(n):
            if count < k and distance[v] == level:
                anchors[count] = v
                count += 1
                relax(indptr, indices, v, distance, queue)


@kernel
def local_maxima(indptr: Ints, indices: Ints, value: Floats, is_maximum: Bools) -> None:
    """Mark the vertices whose value no neighbour exceeds; of equal neighbours the lowest index."""
    for v in range(len(indptr) - 1):
        is_maximum[v] = True
        for at in range(indptr[v], indptr[v + 1]):
            w = indices[at]
            if value[w] > value[v] or (value[w] == value[v] and w < v):
                is_maximum[v] = False


@kernel
def subtract_product(block: Floats, W: Floats, count: int, rows: Ints) -> None:
    """Do block -= W[:, :count] @ W[rows, :count].columns in place.

    In a fixed order of operations: a BLAS gives other last bits for another number of threads, and
    a greedy choice can hang on them. The inner loop runs over a row of the block and is vectorized.
    """
    columns = np.empty((count, len(rows)))
    for j in range(count):
        for c in range(len(rows)):
            columns[j, c] = W[rows[c], j]
    for i in range(len(block)):
        for j in range(count):
            w = W[i, j]
            for c in range(len(rows)):
                block[i, c] -= w * columns[j, c]
