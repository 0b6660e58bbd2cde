"""Neighbours of vertices, and connected components; `src/core/neighbours.c`."""

from __future__ import annotations

from ctypes import byref

import numpy as np

from deltamesh._kernels.core import address, call, ints, ints_out, number, scratch, shorts_out
from deltamesh_formats.array_types import Ints


def gather(a: Ints, b: Ints, n: int) -> tuple[Ints, Ints]:
    """Return the neighbours of n vertices, int64 (n + 1,) and (e,), which ascend, each once.

    a, b : int64 (h,), the vertices at both ends of half-edges, in any order; loops do not count.
    """
    count, entries = len(a), number()
    indptr, indices = np.empty(n + 1, dtype=np.int64), np.empty(2 * count, dtype=np.int32)
    call(
        "dm_gather_neighbours",
        ints(a, count),
        ints(b, count),
        count,
        n,
        ints_out(indptr, n + 1),
        shorts_out(indices, 2 * count),
        byref(entries),
        address(np.empty(2 * count, dtype=np.int32)),
        scratch(n),
    )
    return indptr, indices[: entries.value].astype(np.int64)


def label_components(indptr: Ints, indices: Ints, label: Ints) -> int:
    """Label components (n,) in the order of their lowest vertices; return how many there are."""
    n, entries, count = len(label), len(indices), number()
    graph = ints(indptr, n + 1), n, ints(indices, entries), entries
    call("dm_label_components", *graph, ints_out(label, n), scratch(n), byref(count))
    return count.value
