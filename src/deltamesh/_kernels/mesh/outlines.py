"""Outlines of polygons of merged triangles."""

from __future__ import annotations

from deltamesh._kernels.jit import Int, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge
from deltamesh_formats.array_types import Ints


@kernel
def walk(merged: Ints, corners: Ints, offsets: Ints, of_corners: Ints) -> None:
    """List the corners of the polygons, ascending by their lowest triangles.

    merged : int64 (3 m,), the half-edge that each is merged with, -1 for none; no triangles form a
        ring.
    corners : int64 (c,), offsets : int64 (p + 1,), of_corners : int64 (3 m,), filled in; see
        `polygons.Polygons`.
    """
    of_corners[:] = -1
    at, number = 0, 0
    for t in range(len(merged) // 3):
        if of_corners[3 * t] >= 0:
            continue
        start: Int = 3 * t
        most = 0
        for h in range(3 * t, 3 * t + 3):
            e: Int = h  # first to where the corner begins, then over all of it
            meeting = 1
            while merged[e] >= 0:
                e = next_halfedge(merged[e])
            f: Int = e
            while merged[previous_halfedge(f)] >= 0:
                f = merged[previous_halfedge(f)]
                meeting += 1
            if meeting > most:
                start, most = e, meeting
        e = start
        while True:
            corners[at] = e
            of_corners[e] = at
            f = e
            while merged[previous_halfedge(f)] >= 0:
                f = merged[previous_halfedge(f)]
                of_corners[f] = at
            at += 1
            e = next_halfedge(e)
            while merged[e] >= 0:
                e = next_halfedge(merged[e])
            if e == start:
                break
        number += 1
        offsets[number] = at
