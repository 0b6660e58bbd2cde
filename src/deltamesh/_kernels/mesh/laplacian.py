"""Graph Laplacian L = D - A: its products, and the normal equations; `src/core/laplacian.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import call, floats, floats_out, graph, ints, ints_out, scratch
from deltamesh_formats.array_types import Floats, Ints, Shorts


def apply(indptr: Shorts, indices: Shorts, x: Floats) -> Floats:
    """Return L x for float64 (n, c), each sum in the order of the indices, which ascend."""
    n, columns = x.shape
    out = np.empty((n, columns))
    values = floats(x, n, columns), columns, floats_out(out, n, columns)
    call("dm_apply_laplacian", *graph(indptr, indices, n), *values)
    return out


def smooth(indptr: Shorts, indices: Shorts, x: Floats, rounds: int) -> Floats:
    """Return x, float64 (n, c), smoothed, so that its sums over components stay as they are.

    In each round a vertex keeps half of its value and hands the rest on to its neighbours, in equal
    parts.
    """
    n, out = len(x), x.copy()
    values = floats_out(out, *x.shape), x.shape[1], rounds, floats_out(np.empty_like(out), *x.shape)
    call("dm_smooth", *graph(indptr, indices, n), *values)
    return out


def normal_bounds(indptr: Shorts, indices: Shorts) -> Ints:
    """Return where the rows of L^T L begin and end, int64 (n + 1,)."""
    n = len(indptr) - 1
    bounds = np.empty(n + 1, dtype=np.int64)
    call("dm_normal_bounds", *graph(indptr, indices, n), ints_out(bounds, n + 1), scratch(n))
    return bounds


def normal_matrix(
    indptr: Shorts, indices: Shorts, anchors: Ints, bounds: Ints, weights: Floats | None = None
) -> tuple[Ints, Ints, Floats]:
    """Return L^T L + S^T W S by rows, the columns of each in no order: indptr, indices, values.

    S selects the anchors, W has their weights, 1 by default; the bounds are those of
    `normal_bounds`.
    """
    n, k, filled = len(indptr) - 1, len(anchors), int(bounds[-1])
    columns, values = np.empty(filled, dtype=np.int64), np.empty(filled)
    call(
        "dm_normal_matrix",
        *graph(indptr, indices, n),
        ints(anchors, k),
        floats(np.ones(k) if weights is None else weights, k),
        k,
        ints(bounds, n + 1),
        ints_out(columns, filled),
        floats_out(values, filled),
        filled,
        scratch(n),
    )
    return bounds, columns, values
