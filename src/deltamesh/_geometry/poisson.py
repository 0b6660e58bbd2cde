"""Poisson problem: positions whose graph Laplacian is given, with some vertices held fixed.

L_ff x_f = b_f - L_fc x_c, for the free vertices f and the fixed ones c. It takes 15 to 40
iterations of conjugate gradients on surfaces of any size; the core has the algorithm,
`src/core/multigrid.c`.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.mesh.multigrid import (
    MAX_DENSE,
    MAX_LEVELS,
    Hierarchy,
    Level,
    Singles,
    aggregate,
    choose_block,
    coarsen,
)
from deltamesh._machine import available_cores
from deltamesh_formats.array_types import Floats, Ints, Shorts

# Iterations that no surface needs.
MOST_ITERATIONS: Final = 1000
# What rounding takes from a residual, in units of the terms of its sum.
ROUNDINGS: Final = 4
EPSILON: Final = float(np.finfo(np.float64).eps)


class Poisson:
    """The Laplacian of a graph without its fixed vertices, for any number of right-hand sides.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
        Neighbour lists, from `adjacency.adjacency`.
    fixed : int64 (k,)
        Vertices that keep their positions; every component needs one.
    threads : int, optional
        Those that solve for positions, where there are many. Default: one for each core.
    """

    def __init__(self, graph: Graph, fixed: Ints, threads: int | None = None) -> None:
        diagonal = np.diff(graph[0]).astype(np.float32)
        free = diagonal > 0
        free[fixed] = False
        inverse = np.divide(1, diagonal, out=np.zeros_like(diagonal), where=free)
        block = choose_block(*graph)
        self._hierarchy = Hierarchy(_levels(*graph, diagonal, inverse, block), block)
        self._threads = threads or available_cores()

    def solve(
        self, b: Floats, x: Floats, tolerance: float = 0.0, most: int = MOST_ITERATIONS
    ) -> float:
        """Solve L x = b in the rows of the free vertices, in place.

        Parameters
        ----------
        b : float64 (n, 3)
        x : float64 (n, 3)
            Where the iterations start; fixed vertices have the positions that they keep.
        tolerance : float
            The most by which a coordinate may err; without one, `most` iterations are done, and no
            error is bounded.

        Returns
        -------
        float
            The bound on the error: more than the tolerance after `most` iterations.
        """
        bound, _ = self._hierarchy.solve(b, x, float(tolerance), most, self._threads)
        return bound

    def rounding(self, b: Floats, x: Floats) -> float:
        """Return a bound on the error that solutions near x, float64 (n, 3), have by rounding."""
        largest = float(np.abs(x).max(initial=0.0))
        terms = np.abs(b).max(axis=1) + 2 * self._hierarchy.diagonal * largest
        return self._hierarchy.barrier * ROUNDINGS * EPSILON * float(terms.max(initial=0.0))


def _levels(
    indptr: Shorts, indices: Shorts, diagonal: Singles, inverse: Singles, block: int
) -> list[Level]:
    """Return the levels, the finest first, each at most half as large as the one before.

    The finest is in blocks of so many rows.
    """
    none = np.full(len(diagonal), -1, dtype=np.int32)
    weights = np.zeros(0, dtype=np.float32)
    levels = [Level(indptr, indices, weights, diagonal, inverse, none)]
    while len(levels) < MAX_LEVELS and (len(levels) == 1 or levels[-1].nodes > MAX_DENSE):
        level = levels[-1]
        within = block if len(levels) == 1 else None
        found, count = aggregate(level.indptr, level.indices, level.inverse, within)
        if not count:
            break
        level.aggregate[:] = found
        levels.append(coarsen(level, count))
    return levels
