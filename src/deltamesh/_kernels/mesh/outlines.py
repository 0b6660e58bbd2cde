"""Outlines of polygons of merged triangles; `src/core/outlines.c`."""

from __future__ import annotations

from deltamesh._kernels.core import call, ints, ints_out
from deltamesh_formats.array_types import Ints


def walk(merged: Ints, corners: Ints, offsets: Ints, of_corners: Ints) -> None:
    """List the corners of the polygons, ascending by their lowest triangles.

    merged : int64 (3 m,), the half-edge that each is merged with, -1 for none; no triangles form a
        ring.
    corners : int64 (c,), offsets : int64 (p + 1,), of_corners : int64 (3 m,), filled in; see
        `polygons.Polygons`.
    """
    h, c, p = len(merged), len(corners), len(offsets) - 1
    out = ints_out(corners, c), c, ints_out(offsets, p + 1), p, ints_out(of_corners, h)
    call("dm_walk_outlines", ints(merged, h), h // 3, *out)
