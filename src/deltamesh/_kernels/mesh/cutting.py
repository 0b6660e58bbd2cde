"""Cuts of a triangle complex along edges, until it is an oriented manifold.

See `src/core/cutting.c`.
"""

from __future__ import annotations

from ctypes import byref

import numpy as np

from deltamesh._kernels.core import bools, bools_out, call, ints, ints_out, number, scratch
from deltamesh_formats.array_types import Bools, Ints


def orient(first: Ints, second: Ints, twisted: Bools, parent: Ints, reversed_: Bools) -> None:
    """Reverse faces so that as many pairs as possible agree: union-find with parities.

    first, second : int64 (k,), half-edges on one edge; `twisted` where they run the same way.
    parent : int64 (m,), ends as the root of each face's component.
    reversed_ : bool (m,), at first False, ends as whether to reverse the face: fewer than half of
        each component.
    """
    k, m = len(first), len(parent)
    pairs = ints(first, k), ints(second, k), bools(twisted, k), k
    faces = ints_out(parent, m), bools_out(reversed_, m), m
    call("dm_orient", *pairs, *faces, scratch(m), scratch(m))


def pair_up(order: Ints, bounds: Ints, forward: Bools, component: Ints, opposite: Ints) -> None:
    """Pair half-edges of edges with many faces: those of one component, then across components.

    order : int64, half-edges by edge and by component; edge i has those from bounds[i] on.
    forward : bool (3 m,), component : int64 (m,)
    opposite : int64 (3 m,), filled in.
    """
    length, edges, m = len(order), len(bounds) - 1, len(component)
    rows = ints(order, length), length, ints(bounds, edges + 1), edges
    faces = bools(forward, 3 * m), ints(component, m), ints_out(opposite, 3 * m), m
    call("dm_pair_up", *rows, *faces, scratch(2, length))


def label_fans(opposite: Ints, label: Ints) -> int:
    """Label the fans of corners in the order of first corners; return how many there are."""
    h, count = len(opposite), number()
    call("dm_label_fans", ints(opposite, h), h, ints_out(label, h), byref(count))
    return count.value


def break_slits(opposite: Ints, label: Ints, count: int) -> None:
    """Cut fans that meet a neighbour twice, as at both sides of a slit, into runs that do not.

    A manifold of triangles may have one edge only between two of its vertices.
    """
    h = len(opposite)
    done = np.empty(h, dtype=bool)
    arrays = ints_out(opposite, h), h, ints_out(label, h), count
    call("dm_break_slits", *arrays, scratch(count + h), bools_out(done, h))
