"""Elimination of the unknowns of a symmetric system: an order of little fill, and its fill.

`indptr` and `indices` are the neighbour lists of a symmetric matrix, with its diagonal or without.
See `src/core/elimination.c`.
"""

from __future__ import annotations

from ctypes import byref, c_double

import numpy as np

from deltamesh._kernels.core import call, ints, ints_out, number, scratch
from deltamesh_formats.array_types import Ints


def breadth(indptr: Ints, indices: Ints) -> float:
    """Return the mean count of unknowns on a breadth-first level, of the component with the most.

    Of a surface it is about the root of the count of unknowns, of a random graph nearly all.
    """
    n, found = len(indptr) - 1, c_double()
    memory = scratch(n), scratch(n), scratch(n)
    call("dm_breadth", *_graph(indptr, indices), *memory, byref(found))
    return found.value


def dissect(indptr: Ints, indices: Ints) -> Ints:
    """Return an order of elimination by nested dissection, int64 (n,)."""
    n = len(indptr) - 1
    order = np.empty(n, dtype=np.int64)
    memory = (scratch(size) for size in (n, n, n, n, n + 2, n + 2))
    call("dm_dissect", *_graph(indptr, indices), ints_out(order, n), *memory)
    return order


def minimum_degree(indptr: Ints, indices: Ints) -> Ints:
    """Return an order of elimination by approximate minimum degree, int64 (n,).

    No row names a column twice.
    """
    n, order = len(indptr) - 1, np.empty(len(indptr) - 1, dtype=np.int64)
    memory = scratch(len(indices) + n), scratch(14, n + 1)
    call("dm_minimum_degree", *_graph(indptr, indices), ints_out(order, n), *memory)
    return order


def factor_entries(indptr: Ints, indices: Ints, order: Ints, most: int) -> int:
    """Return the entries of the triangular factor for an order of elimination.

    The count stops as soon as it is above `most`.
    """
    n, count = len(indptr) - 1, number()
    memory = (scratch(n) for _ in range(4))
    graph = _graph(indptr, indices)
    call("dm_factor_entries", *graph, ints(order, n), most, *memory, byref(count))
    return count.value


def product_entries(
    rows: Ints, row_indices: Ints, columns: Ints, column_indices: Ints, most: int
) -> int:
    """Return the entries of A^T A, for A by rows and by columns (indptr and indices of each).

    The count stops as soon as it is above `most`.
    """
    m, n, entries, count = len(rows) - 1, len(columns) - 1, len(row_indices), number()
    call(
        "dm_product_entries",
        ints(rows, m + 1),
        m,
        ints(row_indices, entries),
        entries,
        ints(columns, n + 1),
        n,
        ints(column_indices, entries),
        most,
        scratch(n),
        byref(count),
    )
    return count.value


def _graph(indptr: Ints, indices: Ints) -> tuple[object, ...]:
    n, entries = len(indptr) - 1, len(indices)
    return ints(indptr, n + 1), n, ints(indices, entries), entries
