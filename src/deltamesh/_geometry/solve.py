"""Linear least-squares problem of the decoder.

The reconstruction of O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh
Encoding", SGP 2003, section 3: x' = argmin |A x - b|^2 with A = [L; S] and b = [delta'; c], where
row j of S selects anchor j. All rows of L stay; anchors are added, never substituted. A decoder's
anchors have the weight 1. Others, that of row j of S, are for research and editing; an anchor of
infinite weight keeps its position, and its column leaves the problem.

The normal equations M = A^T A are symmetric positive definite and factored once, but their
condition number is that of A squared: their solution alone has 3-6 correct digits less than it
could have. One step of A. Björck, "Stability analysis of the method of seminormal equations for
linear least squares problems" (Linear Algebra Appl. 88/89, 1987), "corrected seminormal equations",
takes the residual of A rather than of M and brings them back (100k vertices, one anchor, extent 1:
error 9e-9 before, 6e-15 after), for the price of one more back substitution.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TypeVar

import numpy as np

from deltamesh._geometry.normal_equations import factored
from deltamesh._graph.adjacency import Graph, components
from deltamesh._kernels.mesh import laplacian as kernel
from deltamesh._machine import available_cores
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import SolveError

Factor = Callable[[Ints], "LeastSquares"]
T = TypeVar("T")

# Each refinement step multiplies the error by about the size of the previous correction, relative
# to x: below this one, what is left is rounding.
REFINED = 1e-7
MAX_REFINEMENTS = 5
# Below that, corrections have no digits left to settle.
TINY = float(np.finfo(np.float64).tiny)


class LeastSquares:
    """The matrix [L; S] with its factorization, for any number of right-hand sides.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
        Neighbour lists, from `adjacency.adjacency`; L is their Laplacian.
    anchors : int64 (k,)
        Vertices whose positions are given, each once; every component of the graph needs one.
    solver : {"auto", "core", "rslab", "pardiso", "scipy"}
        "auto" is the core for systems that it solves before another would be imported, else rslab
        where it is installed, else scipy. The result differs between solvers by rounding alone.
    threads : int, optional
        For rslab (whose result is the same, bit for bit, for any number) and pardiso. Default: all
        cores. The core and SuperLU of scipy have one.
    memory : float
        Bytes that the factorization may take.
    weights : float, or float64 (k,)
        Of the anchors: positive, and infinite for those that keep their positions.

    Raises
    ------
    LimitError
        If it would take more, before any number of it is computed.
    SolveError
        If a component has no anchor, the solver is unknown or missing, or it fails.
    """

    def __init__(
        self,
        graph: Graph,
        anchors: Ints,
        solver: str = "auto",
        threads: int | None = None,
        memory: float = math.inf,
        weights: float | Floats = 1.0,
    ) -> None:
        self._count, self._labels = anchored_components(graph, anchors)
        self._graph, self._anchors = graph, np.ascontiguousarray(anchors)
        each = np.broadcast_to(np.asarray(weights, dtype=np.float64), len(anchors))
        self._held = np.isposinf(each)
        self._squares = np.where(self._held, 0.0, each * each)[:, None]
        cores = threads or available_cores()
        self._solve = factored(graph, self._anchors, solver, cores, memory, each)

    def solve(self, delta: Floats, positions: Floats) -> Floats:
        """Return argmin |L x - delta|^2 + |W (x[anchors] - positions)|^2, column by column.

        W has the weights of the anchors on its diagonal.

        Parameters
        ----------
        delta : float64 (n, c)
        positions : float64 (k, c)
            In the order of the anchors.

        Returns
        -------
        float64 (n, c)

        Raises
        ------
        SolveError
            If the system is too ill-conditioned for double precision, or overflows it.
        """
        # L maps constants to zero, so the origin of each component is free; far from it digits are
        # lost.
        centres = self._centres(positions)
        fixed = positions - centres[self._labels[self._anchors]]
        x = np.zeros(delta.shape)
        x[self._anchors[self._held]] = fixed[self._held]
        with np.errstate(over="ignore", invalid="ignore"):
            for _ in range(1 + MAX_REFINEMENTS):
                left = delta - kernel.apply(*self._graph, x), fixed - x[self._anchors]
                correction = self.solve_normal(self._transposed(*left))
                x += correction
                if (self._largest(correction) <= REFINED * self._largest(x) + TINY).all():
                    return x + centres[self._labels]
        raise SolveError("the least-squares system has no solution in double precision")

    def _transposed(self, rows: Floats, anchored: Floats) -> Floats:
        """Return [L; W S]^T [b; W c], for b and c; L is symmetric."""
        product = kernel.apply(*self._graph, np.ascontiguousarray(rows))
        product[self._anchors] += self._squares * anchored
        product[self._anchors[self._held]] = 0.0
        return product

    def _centres(self, positions: Floats) -> Floats:
        """Return the mean position of the anchors of each component."""
        of = self._labels[self._anchors]
        sums = [np.bincount(of, column, self._count) for column in positions.T]
        return np.stack(sums, axis=1) / np.bincount(of, minlength=self._count)[:, None]

    def _largest(self, x: Floats) -> Floats:
        """Return the largest magnitude of each component."""
        largest = np.zeros(self._count)
        np.maximum.at(largest, self._labels, np.abs(x).max(axis=1, initial=0.0))
        return largest

    def solve_normal(self, b: Floats) -> Floats:
        """Return M^-1 b for b of shape (n, c), M = L^T L + S^T W^2 S, without refinement.

        The rows and columns of anchors that keep their positions are those of the identity.
        """
        try:
            return np.asarray(self._solve(b))
        except Exception as error:  # each solver has exceptions of its own
            raise SolveError(f"the linear solver failed: {error}") from error


def factorization(
    graph: Graph, solver: str = "auto", threads: int | None = None, memory: float = math.inf
) -> Factor:
    """Return a function of the anchors that makes a `LeastSquares`, and remembers the last one."""
    return remembered(lambda anchors: LeastSquares(graph, anchors, solver, threads, memory))


def remembered(make: Callable[[Ints], T]) -> Callable[[Ints], T]:
    """Return a function of the anchors that remembers its last result.

    A search asks for the same again and again, and factoring is what costs most.
    """
    last = functools.lru_cache(maxsize=1)(lambda data: make(np.frombuffer(data, dtype=np.int64)))
    return lambda anchors: last(anchors.tobytes())


def anchored_components(graph: Graph, anchors: Ints) -> tuple[int, Ints]:
    """Return the number of components, each of which has an anchor, and that of each vertex."""
    labels = components(*graph)
    count = int(labels.max(initial=-1)) + 1
    anchored = np.zeros(count, dtype=bool)
    anchored[labels[anchors]] = True
    if not anchored.all():
        vertex = int(np.argmin(anchored[labels]))
        raise SolveError(f"the component of vertex {vertex} has no anchor: the system is singular")
    return count, labels
