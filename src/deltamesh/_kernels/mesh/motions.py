"""Trees of anchors, and motions of anchors along them; `src/core/motions.c`."""

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


def span(a: Ints, b: Ints, n: int) -> Bools:
    """Return which edges (a, b), int64 (e,), in their order, join two trees of n nodes."""
    count = len(a)
    kept = np.zeros(count, dtype=np.bool_)
    edges = ints(a, count), ints(b, count), count
    call("dm_span", *edges, n, bools_out(kept, count), scratch(n))
    return kept


def walk(indptr: Shorts, indices: Shorts) -> tuple[Ints, Ints]:
    """Return the nodes of trees, each from its lowest node on, breadth first, and their parents.

    The parent of the first node of a tree is -1.
    """
    n = len(indptr) - 1
    order, parent = np.empty(n, dtype=np.int64), np.empty(n, dtype=np.int64)
    forest = graph(indptr, indices, n)
    call("dm_walk_forest", *forest, ints_out(order, n), ints_out(parent, n))
    return order, parent


def carry(
    order: Ints, parent: Ints, rest: Floats, step: float, unit: float, numbers: Ints
) -> tuple[Floats, Floats]:
    """Return positions (n, 3) and quaternions (n, 4) of nodes that have moved by numbers (n, 6)."""
    positions, quaternions = np.zeros_like(rest), np.zeros((len(rest), 4))
    _carry(order, parent, rest, step, unit, numbers.copy(), positions, quaternions, False)
    return positions, quaternions


def measure(
    order: Ints,
    parent: Ints,
    rest: Floats,
    step: float,
    unit: float,
    positions: Floats,
    quaternions: Floats,
) -> Ints:
    """Return the numbers (n, 6) of motions to near positions (n, 3) and quaternions (n, 4)."""
    numbers = np.zeros((len(rest), 6), dtype=np.int64)
    near = positions.copy(), quaternions.copy()
    _carry(order, parent, rest, step, unit, numbers, *near, True)
    return numbers


def _carry(
    order: Ints,
    parent: Ints,
    rest: Floats,
    step: float,
    unit: float,
    numbers: Ints,
    positions: Floats,
    quaternions: Floats,
    measuring: bool,
) -> None:
    n = len(rest)
    call(
        "dm_carry_motions",
        ints(order, n),
        ints(parent, n),
        n,
        floats(rest, n, 3),
        float(step),
        float(unit),
        int(measuring),
        ints_out(numbers, n, 6),
        floats_out(positions, n, 3),
        floats_out(quaternions, n, 4),
    )
