"""The corners of polygons that are triangles glued together."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.jit import Int, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge

_Ints = NDArray[np.int64]


@kernel
def walk(glued: _Ints, corners: _Ints, offsets: _Ints, of_corners: _Ints) -> None:
    """List the corners of the polygons, ascending by their lowest triangles.

    glued : int64 (3 m,), the half-edge that each is glued to, -1 for none; no ring of triangles.
    corners : int64 (c,), offsets : int64 (p + 1,), of_corners : int64 (3 m,), filled in; see
        `polygons.Polygons`.
    """
    of_corners[:] = -1
    at, number = 0, 0
    for t in range(len(glued) // 3):
        if of_corners[3 * t] >= 0:
            continue
        start: Int = 3 * t
        most = 0
        for h in range(3 * t, 3 * t + 3):
            e: Int = h  # first to where the corner begins, then over all of it
            meeting = 1
            while glued[e] >= 0:
                e = next_halfedge(glued[e])
            f: Int = e
            while glued[previous_halfedge(f)] >= 0:
                f = glued[previous_halfedge(f)]
                meeting += 1
            if meeting > most:
                start, most = e, meeting
        e = start
        while True:
            corners[at] = e
            of_corners[e] = at
            f = e
            while glued[previous_halfedge(f)] >= 0:
                f = glued[previous_halfedge(f)]
                of_corners[f] = at
            at += 1
            e = next_halfedge(e)
            while glued[e] >= 0:
                e = next_halfedge(glued[e])
            if e == start:
                break
        number += 1
        offsets[number] = at
