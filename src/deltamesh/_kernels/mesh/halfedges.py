"""Half-edges of triangles, and any others by edge; `src/core/halfedges.c`.

Half-edge h = 3 f + c runs from F[f, c] to F[f, (c + 1) % 3].
"""

from __future__ import annotations

from ctypes import byref, c_int64

import numpy as np

from deltamesh._kernels.core import LIBRARY, address, call, ints, ints_out, number, scratch
from deltamesh_formats.array_types import Ints

LIBRARY.dm_halfedge_after.restype = LIBRARY.dm_halfedge_before.restype = c_int64


def next_halfedge(h: int) -> int:
    """Return the half-edge that follows in the same face, as kernels do, for their tests."""
    after: int = LIBRARY.dm_halfedge_after(c_int64(h))
    return after


def previous_halfedge(h: int) -> int:
    """Return the half-edge that precedes in the same face, likewise."""
    before: int = LIBRARY.dm_halfedge_before(c_int64(h))
    return before


def group_by_edge(start: Ints, end: Ints, n: int) -> tuple[Ints, Ints]:
    """Return half-edges (h,) edge after edge, and where each edge begins; see `halfedges.by_edge`.

    start, end : int64 (h,), of n vertices.
    """
    count, edges = len(start), number()
    order, bounds = np.empty(count, dtype=np.int64), np.empty(count + 1, dtype=np.int64)
    call(
        "dm_group_by_edge",
        ints(start, count),
        ints(end, count),
        count,
        n,
        ints_out(order, count),
        ints_out(bounds, count + 1),
        byref(edges),
        address(np.empty(count, dtype=np.int32)),
        scratch(n + 1),
    )
    return order, bounds[: edges.value + 1].copy()
