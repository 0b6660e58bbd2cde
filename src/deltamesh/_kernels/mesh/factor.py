"""Sparse factorization of a symmetric quasidefinite matrix.

A matrix is given by its rows, both triangles: indptr (n + 1,), indices and values, in any order.
See `src/core/supernodes.c`, `src/core/factor.c` and `src/core/substitution.c`.
"""

from __future__ import annotations

import ctypes
from ctypes import byref, c_int64, c_void_p
from dataclasses import dataclass

import numpy as np

from deltamesh._kernels.core import (
    call,
    constant,
    floats,
    floats_out,
    ints,
    ints_out,
    number,
    scratch,
)
from deltamesh_formats.array_types import Floats, Ints

_TILE, _WIDEST = constant("DM_TILE"), constant("DM_WIDEST")


@dataclass(frozen=True)
class Plan:
    """Order of elimination of a matrix, and the columns that are factored together.

    Attributes
    ----------
    order : int64 (n,)
        The unknowns, as they are eliminated.
    parent, of : int64 (n,)
        The elimination tree, and the supernode of each column.
    starts, row_bounds, panel_bounds : int64 (s + 1,)
        Where the columns, the rows and the entries of the supernodes begin and end.
    tallest : int
        Rows of the panel that has the most.
    """

    order: Ints
    parent: Ints
    of: Ints
    starts: Ints
    row_bounds: Ints
    panel_bounds: Ints
    tallest: int

    @property
    def entries(self) -> int:
        """Entries of all panels."""
        return int(self.panel_bounds[-1])

    @property
    def memory(self) -> int:
        """Bytes that the factorization takes beside the matrix."""
        n, rows = len(self.order), int(self.row_bounds[-1])
        return 8 * (self.entries + rows + self.tallest * _WIDEST + 12 * n)


class _FactorPlan(ctypes.Structure):
    """`dm_factor_plan` of the core."""

    _fields_ = (
        *((name, c_int64) for name in ("n", "supernodes", "row_count", "entries", "tallest")),
        *((name, c_void_p) for name in ("order", "starts", "row_bounds", "panel_bounds")),
        *((name, c_void_p) for name in ("rows", "panels")),
    )


class Factor:
    """Factors L D L^T of a matrix, which a plan has laid out.

    Parameters
    ----------
    plan : Plan
    indptr, indices : int64 (n + 1,), (e,)
    values : float64 (e,)

    Raises
    ------
    ArithmeticError
        If a pivot is zero or not finite.
    """

    def __init__(self, plan: Plan, indptr: Ints, indices: Ints, values: Floats) -> None:
        n, s = len(plan.order), len(plan.starts) - 1
        rows, panels = int(plan.row_bounds[-1]), plan.entries + _TILE
        self._plan = plan
        # The core keeps the pointers; they keep their arrays.
        self._arrays = (
            ints(plan.order, n),
            *(ints(bounds, s + 1) for bounds in (plan.starts, plan.row_bounds, plan.panel_bounds)),
            ints_out(np.empty(rows, dtype=np.int64), rows),
            floats_out(np.zeros(panels), panels),
        )
        self._factors = _FactorPlan(n, s, rows, plan.entries, plan.tallest, *self._arrays)
        pivot = number()
        block = (plan.tallest + _TILE) * _WIDEST
        call(
            "dm_factor",
            *_matrix(indptr, indices),
            floats(values, len(indices)),
            byref(self._factors),
            ints(plan.parent, n),
            ints(plan.of, n),
            *(scratch(size) for size in (n, n, s, s, s)),
            *(floats_out(np.empty(size), size) for size in (block, _WIDEST * _TILE)),
            byref(pivot),
        )
        if pivot.value >= 0:
            raise ArithmeticError(f"the pivot of unknown {plan.order[pivot.value]} is zero")

    def solve(self, b: Floats) -> Floats:
        """Return the solutions x of M x = b, float64 (n, c)."""
        x = np.array(b, order="C")
        n, columns = x.shape
        ordered, sums = np.empty(x.shape), np.empty((self._plan.tallest, columns))
        memory = (floats_out(array, *array.shape) for array in (ordered, sums))
        factors = byref(self._factors)
        call("dm_solve_factored", factors, floats_out(x, n, columns), columns, *memory)
        return x


def plan(indptr: Ints, indices: Ints, order: Ints, most: int) -> Plan | None:
    """Return the plan of a factorization in an order of elimination, or one of the same fill.

    Where the factor would have more than `most` entries, return None.
    """
    n = len(indptr) - 1
    order, sizes = order.copy(), np.empty(4, dtype=np.int64)
    parent, of = np.empty((2, n), dtype=np.int64)
    starts, row_bounds, panel_bounds = np.empty((3, n + 1), dtype=np.int64)
    call(
        "dm_plan",
        *_matrix(indptr, indices),
        ints_out(order, n),
        most,
        ints_out(parent, n),
        ints_out(starts, n + 1),
        ints_out(of, n),
        ints_out(row_bounds, n + 1),
        ints_out(panel_bounds, n + 1),
        ints_out(sizes, 4),
        *(scratch(n) for _ in range(4)),
    )
    supernodes, tallest = int(sizes[0]), int(sizes[3])
    if supernodes < 0:
        return None
    end = supernodes + 1
    bounds = starts[:end].copy(), row_bounds[:end].copy(), panel_bounds[:end].copy()
    return Plan(order, parent, of, *bounds, tallest)


def _matrix(indptr: Ints, indices: Ints) -> tuple[object, ...]:
    n, entries = len(indptr) - 1, len(indices)
    return ints(indptr, n + 1), n, ints(indices, entries), entries
