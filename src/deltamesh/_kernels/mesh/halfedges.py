"""Half-edges of triangles. Half-edge h = 3 f + c runs from F[f, c] to F[f, (c + 1) % 3].

Within kernels, `src/core/halfedges.h`; the functions here are for their tests.
"""

from __future__ import annotations

from ctypes import c_int64

from deltamesh._kernels.core import LIBRARY

LIBRARY.dm_halfedge_after.restype = LIBRARY.dm_halfedge_before.restype = c_int64


def next_halfedge(h: int) -> int:
    """Return the half-edge that follows in the same face."""
    after: int = LIBRARY.dm_halfedge_after(c_int64(h))
    return after


def previous_halfedge(h: int) -> int:
    """Return the half-edge that precedes in the same face."""
    before: int = LIBRARY.dm_halfedge_before(c_int64(h))
    return before
