"""Multigrid and conjugate gradients for the Poisson problem; `src/core/multigrid.c`.

Matrices are symmetric, given by their rows: indptr (n + 1,) and indices as int32, of the entries
off the diagonal, which are the negative weights as float32, or -1 without any.
"""

from __future__ import annotations

from ctypes import byref, c_double
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.core import (
    address,
    call,
    constant,
    floats,
    floats_out,
    ints,
    number,
    scratch,
    shorts,
    shorts_out,
    singles,
    singles_out,
)
from deltamesh._kernels.sharing import shared
from deltamesh_formats.array_types import Floats, Shorts

Singles = NDArray[np.float32]

COORDINATES, LANES = map(constant, ("DM_COORDINATES", "DM_LANES"))
MAX_LEVELS, MAX_DENSE, BLOCK = map(constant, ("DM_MAX_LEVELS", "DM_MAX_DENSE", "DM_BLOCK"))


@dataclass(frozen=True)
class Level:
    """One level of a hierarchy.

    Attributes
    ----------
    indptr, indices : int32 (n + 1,), (e,)
    weights : float32 (e,), or (0,) on the finest level, where all are 1
    diagonal, inverse : float32 (n,)
        The latter is 0 for fixed nodes.
    aggregate : int32 (n,)
        The node of the next level; -1 for none.
    """

    indptr: Shorts
    indices: Shorts
    weights: Singles
    diagonal: Singles
    inverse: Singles
    aggregate: Shorts

    @property
    def nodes(self) -> int:
        """Nodes of the level."""
        return len(self.diagonal)

    def matrix(self) -> Floats:
        """Return the matrix of a coarse level, dense, float64 (n, n)."""
        dense = np.diag(self.diagonal.astype(np.float64))
        rows = np.repeat(np.arange(self.nodes), np.diff(self.indptr))
        dense[rows, self.indices] -= self.weights
        return dense


def choose_block(indptr: Shorts, indices: Shorts) -> int:
    """Return the rows of a block of the finest level: `BLOCK`, or all where blocks would not do."""
    n, entries, found = len(indptr) - 1, len(indices), number()
    call(
        "dm_choose_block", shorts(indptr, n + 1), n, shorts(indices, entries), entries, byref(found)
    )
    return found.value


def aggregate(
    indptr: Shorts, indices: Shorts, inverse: Singles, block: int | None = None
) -> tuple[Shorts, int]:
    """Return the aggregate of each node, int32 (n,), or -1 where it needs none; and their number.

    Fixed nodes, whose `inverse` is 0, and those without free neighbours in their block of so many
    nodes, by default a block of all, need none.
    """
    n, entries, count = len(indptr) - 1, len(indices), number()
    found = np.empty(n, dtype=np.int32)
    graph = shorts(indptr, n + 1), n, shorts(indices, entries), entries
    own = singles(inverse, n), block or max(n, 1)
    call("dm_aggregate", *graph, *own, shorts_out(found, n), byref(count))
    return found, count.value


def coarsen(level: Level, count: int) -> Level:
    """Return the level above one with so many aggregates: P^T A P; it has no aggregates yet."""
    n, entries, end = level.nodes, len(level.indices), number()
    indptr = np.empty(count + 1, dtype=np.int32)
    indices = np.empty(entries, dtype=np.int32)
    weights = np.empty(entries, dtype=np.float32)
    diagonal = np.empty(count, dtype=np.float32)
    has_weights = len(level.weights) > 0
    call(
        "dm_coarsen",
        shorts(level.indptr, n + 1),
        n,
        shorts(level.indices, entries),
        entries,
        singles(level.weights, entries) if has_weights else None,
        singles(level.diagonal, n),
        shorts(level.aggregate, n),
        count,
        shorts_out(indptr, count + 1),
        shorts_out(indices, entries),
        singles_out(weights, entries),
        singles_out(diagonal, count),
        byref(end),
        *(scratch(size) for size in (n, count + 1, count + 1)),
    )
    e, none = end.value, np.full(count, -1, dtype=np.int32)
    inverse = np.divide(1, diagonal, dtype=np.float32)
    return Level(indptr, indices[:e].copy(), weights[:e].copy(), diagonal, inverse, none)


def factor_dense(matrix: Floats) -> Floats:
    """Return the lower triangle of Cholesky's factor of a small matrix, float64 (n, n)."""
    factor = matrix.copy()
    call("dm_factor_dense", floats_out(factor, *matrix.shape), len(matrix))
    return factor


class Hierarchy:
    """Levels in the arrays that the core walks along; the finest keeps its own rows, a graph's.

    Parameters
    ----------
    levels : list of Level
        The finest first; at most `MAX_LEVELS`. The coarsest of several is solved exactly if it has
        at most `MAX_DENSE` nodes.
    block : int
        Of the finest level, the rows of each block, within which its aggregates are.

    Attributes
    ----------
    barrier : float
        A bound on the sums of the rows of |A^-1|, which the first solve finds; 0 before.
    """

    def __init__(self, levels: list[Level], block: int = BLOCK) -> None:
        self.n, self._block = levels[0].nodes, block
        self._sizes = np.array([level.nodes for level in levels], dtype=np.int64)
        self._entries = np.array([len(level.indices) for level in levels], dtype=np.int64)
        self._rows = levels[0].indptr, levels[0].indices
        others = [(level.indptr, level.indices, level.weights) for level in levels[1:]]
        none = np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, np.float32)
        self._coarse = [np.concatenate(column) for column in zip(none, *others, strict=True)]
        numbers = [(level.diagonal, level.inverse, level.aggregate) for level in levels]
        self._numbers = [np.concatenate(column) for column in zip(*numbers, strict=True)]
        last = levels[-1]
        is_dense = len(levels) > 1 and 0 < last.nodes <= MAX_DENSE
        self._factor = factor_dense(last.matrix()) if is_dense else np.zeros((0, 0))
        self.barrier = 0.0

    @property
    def diagonal(self) -> Singles:
        """The diagonal of the finest level, float32 (n,)."""
        return self._numbers[0][: self.n]

    def solve(
        self, b: Floats, x: Floats, tolerance: float, most: int, threads: int = 1
    ) -> tuple[float, int]:
        """Solve A x = b in place, from where x starts; fixed nodes keep their x.

        Parameters
        ----------
        b, x : float64 (n, 3)
        tolerance : float
            It ends where no coordinate errs more; at 0, no barrier is looked for.
        most : int
            Iterations after which it ends all the same.
        threads : int
            They share the blocks; the result does not depend on them.

        Returns
        -------
        float
            Bound on the error of the coordinates; infinite where none is proved.
        int
            Iterations.
        """
        n, levels, nodes = self.n, len(self._sizes), int(self._sizes.sum())
        coarse, entries = nodes - n, int(self._entries[1:].sum())
        (indptr, indices, weights), (diagonal, inverse, aggregate) = self._coarse, self._numbers
        barrier, bound, done = c_double(self.barrier), c_double(), number()
        cycle = (np.empty((coarse, LANES), dtype=np.float32) for _ in range(2))
        blocks = -(-n // self._block)
        with shared("dm_solve_block", min(threads, blocks)) as each:
            call(
                "dm_solve_poisson",
                ints(self._sizes, levels),
                ints(self._entries, levels),
                levels,
                shorts(self._rows[0], n + 1),
                shorts(self._rows[1], int(self._entries[0])),
                shorts(indptr, coarse + levels - 1),
                shorts(indices, entries),
                singles(weights, entries),
                singles(diagonal, nodes),
                singles(inverse, nodes),
                shorts(aggregate, nodes),
                floats(self._factor, *self._factor.shape),
                len(self._factor),
                floats(b, n, COORDINATES),
                floats_out(x, n, COORDINATES),
                tolerance,
                most,
                byref(barrier),
                byref(bound),
                byref(done),
                self._block,
                each,
                address(np.empty((blocks, LANES))),
                address(np.empty(n)),
                *(address(np.empty((n, LANES))) for _ in range(3)),
                *map(address, cycle),
                address(np.empty(n, dtype=np.uint8)),
            )
        self.barrier = barrier.value
        return bound.value, done.value
