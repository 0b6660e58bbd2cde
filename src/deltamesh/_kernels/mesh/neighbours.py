"""Neighbours of vertices, and connected components; `src/core/neighbours.c`."""

from __future__ import annotations

from ctypes import byref

from deltamesh._kernels.core import call, ints, ints_out, number, scratch
from deltamesh_formats.array_types import Ints


def fill(pairs: Ints, indptr: Ints, indices: Ints) -> None:
    """Fill in the neighbours of the vertices, which ascend.

    pairs : int64 (e, 2), the edges (i, j), i < j < n, each once, in lexicographic order.
    indptr : int64 (n + 1,), indices : int64 (2 e,), filled in.
    """
    e, n = len(pairs), len(indptr) - 1
    call(
        "dm_fill_neighbours",
        ints(pairs, e, 2),
        e,
        n,
        ints_out(indptr, n + 1),
        ints_out(indices, 2 * e),
    )


def label_components(indptr: Ints, indices: Ints, label: Ints) -> int:
    """Label components (n,) in the order of their lowest vertices; return how many there are."""
    n, entries, count = len(label), len(indices), number()
    graph = ints(indptr, n + 1), n, ints(indices, entries), entries
    call("dm_label_components", *graph, ints_out(label, n), scratch(n), byref(count))
    return count.value
