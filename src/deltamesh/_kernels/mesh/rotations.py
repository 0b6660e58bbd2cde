"""Rotations of neighbourhoods, and deltas turned by them; `src/core/rotations.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import call, floats, floats_out, graph
from deltamesh_formats.array_types import Floats, Shorts

MOMENTS = 11


def fit(indptr: Shorts, indices: Shorts, before: Floats, after: Floats, rings: int) -> Floats:
    """Return the rotations of the edges around vertices (n, 3), float64 (n, 3, 3)."""
    n = len(before)
    turns, moments, wider = np.empty((n, 3, 3)), np.empty((n, MOMENTS)), np.empty((n, MOMENTS))
    call(
        "dm_fit_rotations",
        *graph(indptr, indices, n),
        floats(before, n, 3),
        floats(after, n, 3),
        rings,
        floats_out(turns, n, 3, 3),
        floats_out(moments, n, MOMENTS),
        floats_out(wider, n, MOMENTS),
    )
    return turns


def nearest(matrices: Floats) -> Floats:
    """Return the rotations that are nearest to matrices, float64 (n, 3, 3)."""
    n = len(matrices)
    turns = np.empty((n, 3, 3))
    call("dm_nearest_rotations", floats(matrices, n, 3, 3), n, floats_out(turns, n, 3, 3))
    return turns


def turned_deltas(indptr: Shorts, indices: Shorts, vertices: Floats, turns: Floats) -> Floats:
    """Return the deltas of vertices (n, 3), turned by matrices (n, 3, 3), float64 (n, 3)."""
    n = len(vertices)
    out = np.empty((n, 3))
    surface = *graph(indptr, indices, n), floats(vertices, n, 3), floats(turns, n, 3, 3)
    call("dm_turned_deltas", *surface, floats_out(out, n, 3))
    return out
