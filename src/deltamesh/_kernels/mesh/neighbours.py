"""Neighbours of vertices, and connected components; `src/core/neighbours.c`."""

from __future__ import annotations

from ctypes import byref

import numpy as np

from deltamesh._kernels.core import (
    address,
    call,
    graph,
    ints,
    ints_out,
    number,
    scratch,
    shorts_out,
)
from deltamesh_formats.array_types import Ints, Shorts


def gather(a: Ints, b: Ints, n: int) -> tuple[Shorts, Shorts]:
    """Return the neighbours of n vertices, int32 (n + 1,) and (e,), which ascend, each once.

    a, b : int64 (h,), the vertices at both ends of half-edges, in any order; loops do not count.
    """
    count, entries = len(a), number()
    indptr, indices = np.empty(n + 1, dtype=np.int32), np.empty(2 * count, dtype=np.int32)
    call(
        "dm_gather_neighbours",
        ints(a, count),
        ints(b, count),
        count,
        n,
        shorts_out(indptr, n + 1),
        shorts_out(indices, 2 * count),
        byref(entries),
        address(np.empty(2 * count, dtype=np.int32)),
        address(np.empty(n, dtype=np.int32)),
    )
    return indptr, indices[: entries.value].copy()


def label_components(indptr: Shorts, indices: Shorts, label: Ints) -> int:
    """Label components (n,) in the order of their lowest vertices; return how many there are."""
    n, count = len(label), number()
    found = ints_out(label, n), scratch(n), byref(count)
    call("dm_label_components", *graph(indptr, indices, n), *found)
    return count.value
