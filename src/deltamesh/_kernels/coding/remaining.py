"""Sets whose elements are used up one by one: the rest in order of index, and in rings.

Counts are in a tree of partial sums (Fenwick, "A new data structure for cumulative frequency
tables", 1994), the next index that is left is found by path halving (Tarjan, van Leeuwen, 1984).
A ring is a circular list of those elements of a group that are left, with an element to begin at.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Ints


class Remaining(NamedTuple):
    """The indices below n that are left.

    Attributes
    ----------
    sums : int64 (n + 1,)
        sums[i] counts those among the last (i & -i) below i.
    onwards : int64 (n + 1,)
        An index not above the next that is left; itself if it is left, or n.
    """

    sums: Ints
    onwards: Ints


class Rings(NamedTuple):
    """The rings of some groups.

    Attributes
    ----------
    after, before : int64 (e,)
        The neighbours of an element on its ring.
    start : int64 (g,)
        An element of each group, -1 when none is left.
    """

    after: Ints
    before: Ints
    start: Ints


@kernel
def all_of(n: Int) -> Remaining:
    """Return all indices below n."""
    sums = np.zeros(n + 1, np.int64)
    onwards = np.empty(n + 1, np.int64)
    for i in range(n + 1):
        sums[i], onwards[i] = i & -i, i
    return Remaining(sums, onwards)


@inlined
def remove(r: Remaining, index: Int) -> None:
    """Take away an index that is left."""
    r.onwards[index] = index + 1
    i = index + 1
    while i < r.sums.size:
        r.sums[i] -= 1
        i += i & -i


@inlined
def next_left(r: Remaining, index: Int) -> Int:
    """Return the lowest index left that is not below `index`, else the lowest; there is one."""
    onwards = r.onwards
    n = onwards.size - 1
    i = index
    while onwards[i] != i:
        onwards[i] = onwards[onwards[i]]
        i = onwards[i]
    if i == n:
        i = 0
        while onwards[i] != i:
            onwards[i] = onwards[onwards[i]]
            i = onwards[i]
    return i


@inlined
def count_below(r: Remaining, index: Int) -> Int:
    """Return how many are left below `index`."""
    total: Int = 0
    i = index
    while i > 0:
        total += r.sums[i]
        i -= i & -i
    return total


@inlined
def select(r: Remaining, rank: Int) -> Int:
    """Return the index below which `rank` are left, itself left; `rank` is below their number."""
    step = 1
    while 2 * step < r.sums.size:
        step *= 2
    at: Int = 0
    rest = rank
    while step > 0:
        if at + step < r.sums.size and r.sums[at + step] <= rest:
            at += step
            rest -= r.sums[at]
        step >>= 1
    return at


@kernel
def rings_of(groups: Ints, count: Int) -> Rings:
    """Return the rings of elements in ascending order; element e belongs to `groups[e]`."""
    after, before = np.empty(groups.size, np.int64), np.empty(groups.size, np.int64)
    start = np.full(count, -1, np.int64)
    for e in range(groups.size):
        first = start[groups[e]]
        if first < 0:
            start[groups[e]] = e
            after[e], before[e] = e, e
        else:
            last = before[first]
            after[last], before[e] = e, last
            after[e], before[first] = first, e
    return Rings(after, before, start)


@inlined
def leave_ring(r: Rings, group: Int, element: Int) -> None:
    """Take an element off its ring, which then begins after it."""
    following = r.after[element]
    if following == element:
        r.start[group] = -1
        return
    previous = r.before[element]
    r.after[previous], r.before[following] = following, previous
    r.start[group] = following
