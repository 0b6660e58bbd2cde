"""Elimination of the unknowns of a symmetric system: an order of little fill, and its fill.

`indptr` and `indices` are the neighbour lists of a symmetric matrix, with its diagonal or without.

Sources: A. George, J. W. H. Liu, "An automatic nested dissection algorithm for irregular finite
element problems", SIAM J. Numer. Anal. 15, 1978 (separators from breadth-first levels); J. W. H.
Liu, "The role of elimination trees in sparse factorization", SIAM J. Matrix Anal. 11, 1990 (the
tree, and the rows of a factor from it).
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.jit import Int, kernel
from deltamesh_formats.array_types import Ints

# Unknowns that are not worth a separator.
LEAF = 24
# Nearly every separator would contain an unknown with more than that many neighbours, times the
# root of the count of unknowns: those come last, as in approximate minimum degree orderings.
DENSE = 10
# Searches for a pair of unknowns that are far from each other.
SEARCHES = 4
DONE = -1


@kernel
def search(indptr: Ints, indices: Ints, part: Ints, start: Int, queue: Ints, level: Ints) -> Int:
    """Return the count of the unknowns of a connected part, after filling `queue` with them.

    The search is breadth-first; `level`, -1 before, becomes the distance from `start`.
    """
    queue[0] = start
    level[start] = 0
    head, tail = 0, 1
    while head < tail:
        v = queue[head]
        head += 1
        for at in range(indptr[v], indptr[v + 1]):
            w = indices[at]
            if part[w] == part[start] and level[w] < 0:
                level[w] = level[v] + 1
                queue[tail] = w
                tail += 1
    return tail


@kernel
def breadth(indptr: Ints, indices: Ints) -> float:
    """Return the mean count of unknowns on a breadth-first level, of the component with the most.

    Of a surface it is about the root of the count of unknowns, of a random graph nearly all.
    """
    n = len(indptr) - 1
    part, level, queue = np.zeros(n, np.int64), np.full(n, -1, np.int64), np.empty(n, np.int64)
    most = 0.0
    for v in range(n):
        if level[v] < 0:
            count = search(indptr, indices, part, v, queue, level)
            most = max(most, count / (level[queue[count - 1]] + 1))
    return most


@kernel
def halve(
    indptr: Ints, indices: Ints, part: Ints, order: Ints, queue: Ints, level: Ints
) -> tuple[Int, Int]:
    """Put a connected part into an order of two halves and their separator; return two counts.

    `queue` and `level` are from `search`, of the part and from an end of it; `order` is its share
    of the order. The counts are of the first half and of both.
    """
    count = len(order)
    last = level[queue[count - 1]]
    middle = min(level[queue[count // 2]], last - 1)
    low, high = 0, count
    for i in range(count):
        v = queue[i]
        beyond = False
        if level[v] == middle:
            for at in range(indptr[v], indptr[v + 1]):
                w = indices[at]
                if part[w] == part[v] and level[w] > middle:
                    beyond = True
                    break
        if beyond:
            high -= 1
            order[high] = v
        elif level[v] <= middle:
            order[low] = v
            low += 1
    at_high = low
    for i in range(count):
        if level[queue[i]] > middle:
            order[at_high] = queue[i]
            at_high += 1
    return low, high


@kernel
def dissect(indptr: Ints, indices: Ints) -> Ints:
    """Return an order of elimination by nested dissection, int64 (n,)."""
    n = len(indptr) - 1
    order, part, level = np.empty(n, np.int64), np.zeros(n, np.int64), np.full(n, -1, np.int64)
    queue, old = np.empty(n, np.int64), np.empty(n, np.int64)
    dense = max(100.0, DENSE * np.sqrt(n))
    first, last = 0, n
    for v in range(n):
        if indptr[v + 1] - indptr[v] > dense:
            last -= 1
            order[last] = v
            part[v] = DONE
        else:
            order[first] = v
            first += 1
    begins, ends = np.empty(n + 2, np.int64), np.empty(n + 2, np.int64)
    begins[0], ends[0] = 0, last
    waiting, parts = 1, 1
    while waiting:
        waiting -= 1
        a, b = begins[waiting], ends[waiting]
        if b - a <= LEAF:
            continue
        count = search(indptr, indices, part, order[a], queue, level)
        if count < b - a:  # several components, side by side from now on
            old[: b - a] = order[a:b]
            at = a
            for i in range(b - a):
                v = old[i]
                if i and level[v] >= 0:
                    continue
                if i:
                    count = search(indptr, indices, part, v, queue, level)
                order[at : at + count] = queue[:count]
                begins[waiting], ends[waiting] = at, at + count
                waiting += 1
                at += count
            for at_part in range(waiting - 1, -1, -1):
                if begins[at_part] < a or ends[at_part] > b:
                    break
                for i in range(begins[at_part], ends[at_part]):
                    part[order[i]] = parts
                    level[order[i]] = -1
                parts += 1
            continue
        depth = level[queue[count - 1]]
        for _ in range(SEARCHES):
            end = queue[count - 1]
            for i in range(count):
                level[queue[i]] = -1
            search(indptr, indices, part, end, queue, level)
            deeper = level[queue[count - 1]] > depth
            depth = level[queue[count - 1]]
            if not deeper:
                break
        if depth >= 2:
            low, high = halve(indptr, indices, part, order[a:b], queue, level)
            for i in range(a, b):
                part[order[i]] = parts if i < a + low else parts + 1 if i < a + high else DONE
            parts += 2
            begins[waiting], ends[waiting] = a, a + low
            begins[waiting + 1], ends[waiting + 1] = a + low, a + high
            waiting += 2
        for i in range(count):
            level[queue[i]] = -1
    return order


@kernel
def factor_entries(indptr: Ints, indices: Ints, order: Ints, most: Int) -> Int:
    """Return the entries of the triangular factor for an order of elimination.

    The count stops as soon as it is above `most`.
    """
    n = len(indptr) - 1
    rank, parent = np.empty(n, np.int64), np.full(n, -1, np.int64)
    ancestor, seen = np.full(n, -1, np.int64), np.full(n, -1, np.int64)
    for i in range(n):
        rank[order[i]] = i
    for i in range(n):
        for at in range(indptr[order[i]], indptr[order[i] + 1]):
            j = rank[indices[at]]
            while 0 <= j < i:
                above = ancestor[j]
                ancestor[j] = i
                if above < 0:
                    parent[j] = i
                j = above
    # Row i of the factor has an entry at all that are on the way from its neighbours up to i.
    entries = n
    for i in range(n):
        seen[i] = i
        for at in range(indptr[order[i]], indptr[order[i] + 1]):
            j = rank[indices[at]]
            while j < i and seen[j] != i:
                seen[j] = i
                entries += 1
                j = parent[j]
        if entries > most:
            break
    return entries


@kernel
def product_entries(
    rows: Ints, row_indices: Ints, columns: Ints, column_indices: Ints, most: Int
) -> Int:
    """Return the entries of A^T A, for A by rows and by columns (indptr and indices of each).

    The count stops as soon as it is above `most`.
    """
    n = len(columns) - 1
    seen = np.full(n, -1, np.int64)
    entries = 0
    for j in range(n):
        for at in range(columns[j], columns[j + 1]):
            i = column_indices[at]
            for there in range(rows[i], rows[i + 1]):
                k = row_indices[there]
                if seen[k] != j:
                    seen[k] = j
                    entries += 1
        if entries > most:
            break
    return entries
