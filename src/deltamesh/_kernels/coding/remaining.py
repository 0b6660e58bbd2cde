"""Sets whose elements are used up one by one: the rest in order of index, and in rings.

Within kernels, `src/core/remaining.h`; here they are for their tests.
"""

from __future__ import annotations

from ctypes import byref
from typing import NamedTuple

import numpy as np

from deltamesh._kernels.core import LIBRARY, call, ints, ints_out, number
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


def all_of(n: int) -> Remaining:
    """Return all indices below n."""
    r = Remaining(*np.empty((2, n + 1), dtype=np.int64))
    LIBRARY.dm_all_of(*_arguments(r))
    return r


def _arguments(r: Remaining) -> tuple[object, ...]:
    size = len(r.sums)
    n = number()
    n.value = size - 1
    return n, ints_out(r.sums, size), ints_out(r.onwards, size)


def remove(r: Remaining, index: int) -> None:
    """Take away an index that is left."""
    call("dm_remove", *_arguments(r), index)


def _found(name: str, r: Remaining, argument: int) -> int:
    found = number()
    call(name, *_arguments(r), argument, byref(found))
    return found.value


def next_left(r: Remaining, index: int) -> int:
    """Return the lowest index left that is not below `index`, else the lowest; there is one."""
    return _found("dm_next_left", r, index)


def count_below(r: Remaining, index: int) -> int:
    """Return how many are left below `index`."""
    return _found("dm_count_below", r, index)


def select(r: Remaining, rank: int) -> int:
    """Return the index below which `rank` are left, itself left; `rank` is below their number."""
    return _found("dm_select", r, rank)


def rings_of(groups: Ints, count: int) -> Rings:
    """Return the rings of elements in ascending order; element e belongs to `groups[e]`."""
    e = len(groups)
    r = Rings(*(np.empty(size, dtype=np.int64) for size in (e, e, count)))
    call("dm_rings_of", ints(groups, e), e, count, *_ring_arrays(r))
    return r


def _ring_arrays(r: Rings) -> tuple[object, ...]:
    e = len(r.after)
    return ints_out(r.after, e), ints_out(r.before, e), ints_out(r.start, len(r.start))


def leave_ring(r: Rings, group: int, element: int) -> None:
    """Take an element off its ring, which then begins after it."""
    call("dm_leave_ring", len(r.after), len(r.start), *_ring_arrays(r), group, element)
