"""Rotations of neighbourhoods, and deltas turned by them; `src/core/rotations.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import call, floats, floats_out, ints
from deltamesh_formats.array_types import Floats, Ints

MOMENTS = 11


def fit(indptr: Ints, indices: Ints, before: Floats, after: Floats, rings: int) -> Floats:
    """Return the rotations of the edges around vertices (n, 3), float64 (n, 3, 3)."""
    n = len(before)
    turns, moments, wider = np.empty((n, 3, 3)), np.empty((n, MOMENTS)), np.empty((n, MOMENTS))
    call(
        "dm_fit_rotations",
        *_graph(indptr, indices),
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


def turned_deltas(indptr: Ints, indices: Ints, vertices: Floats, turns: Floats) -> Floats:
    """Return the deltas of vertices (n, 3), turned by matrices (n, 3, 3), float64 (n, 3)."""
    n = len(vertices)
    out = np.empty((n, 3))
    surface = *_graph(indptr, indices), floats(vertices, n, 3), floats(turns, n, 3, 3)
    call("dm_turned_deltas", *surface, floats_out(out, n, 3))
    return out


def _graph(indptr: Ints, indices: Ints) -> tuple[object, ...]:
    n, entries = len(indptr) - 1, len(indices)
    return ints(indptr, n + 1), n, ints(indices, entries), entries
