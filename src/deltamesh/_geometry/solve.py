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

import contextlib
import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar, cast

import numpy as np

from deltamesh._geometry.fill import MATRIX_ENTRY, check_memory, pattern
from deltamesh._geometry.solvers import (
    SMALL,
    SMALL_FACTOR,
    SOLVERS,
    Solve,
    factor_normal,
    solver_name,
)
from deltamesh._graph.adjacency import Graph, components
from deltamesh._graph.laplacian import laplacian
from deltamesh._kernels.mesh import elimination
from deltamesh._kernels.mesh import laplacian as kernel
from deltamesh._machine import available_cores
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import LimitError, SolveError

if TYPE_CHECKING:
    import scipy.sparse as sparse

Factor = Callable[[Ints], "LeastSquares"]
T = TypeVar("T")

# A row of L with d entries puts d^2 entries into L^T L: one vertex with 50 000 neighbours would ask
# for 20 GB. Longer rows become unknowns of their own, see `_quasidefinite`.
LONGEST_ROW = 100

# Weight of the pins of `_quasidefinite`: far above rounding, far below the weight 1 of an anchor.
PIN = 1e-5

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
        self._solve = _factor(graph, self._anchors, solver, cores, memory, each)

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


def _factor(
    graph: Graph, anchors: Ints, solver: str, threads: int, memory: float, weights: Floats
) -> Solve:
    """Return a function that solves A^T A x = b, for A = [L; W S]."""
    n, name = len(graph[0]) - 1, solver_name(solver)
    if n == 0:
        return np.copy
    short = bool(np.diff(graph[0]).max() < LONGEST_ROW and np.isfinite(weights).all())
    if short and solver == "auto" and n <= SMALL:
        with contextlib.suppress(LimitError, ArithmeticError):  # which another may escape
            if solve := factor_normal(graph, anchors, weights * weights, memory, SMALL_FACTOR):
                return solve
    try:
        if short and name == "core":
            return cast(Solve, factor_normal(graph, anchors, weights * weights, memory))
        matrix = _matrix(graph, anchors, memory, weights)
        solve = SOLVERS[name].factor(matrix, threads, memory)
    except LimitError:
        raise
    except Exception as error:  # each solver has exceptions of its own
        raise SolveError(f"solver {name!r} failed: {error}") from error
    if matrix.shape[0] == n:
        return solve
    return lambda b: solve(np.pad(b, ((0, matrix.shape[0] - n), (0, 0))))[:n]


def _matrix(graph: Graph, anchors: Ints, memory: float, weights: Floats) -> sparse.csr_array:
    """Return A^T A or its stand-in, see `_quasidefinite`."""
    import scipy.sparse as sparse  # 0.2 s, which small systems need not wait for

    L, k = laplacian(*graph), len(anchors)
    held = np.isposinf(weights)
    if held.any():
        free = np.ones(L.shape[0])
        free[anchors[held]] = 0.0
        L = (L @ sparse.diags_array(free)).tocsr()
    rows = np.where(held, 1.0, weights)
    S = sparse.csr_array((rows, (np.arange(k), anchors)), shape=(k, L.shape[0]))
    A = sparse.vstack([L, S], format="csr")
    return _quasidefinite(A, A.T.tocsr(), memory)


def _quasidefinite(
    A: sparse.csr_array, transposed: sparse.csr_array, memory: float = math.inf
) -> sparse.csr_array:
    """Return A^T A or, where A has rows of more than `LONGEST_ROW` entries, a sparser stand-in.

    With the long rows R and the others B, (B^T B + R^T R) x = b is the first block of
    [B^T B, R^T; R, -I] [x; R x] = [b; 0]. With a definite B^T B such a matrix is symmetric
    quasidefinite and has an L D L^T factorization in every order (R. J. Vanderbei, "Symmetric
    quasidefinite matrices", SIAM J. Optim. 5, 1995). B alone may be singular; B and a weak pin on
    every vertex whose row was taken (a Dirichlet problem) is not. Refinement removes the pins.
    """
    import scipy.sparse as sparse

    is_long = np.diff(A.indptr) > LONGEST_ROW
    if not is_long.any():
        _check_product(A, transposed, memory)
        return (transposed @ A).tocsr()
    short, long = A[~is_long], A[is_long]
    columns = short.T.tocsr()
    _check_product(short, columns, memory)
    # Row i of A is row i of L, which comes first; an anchor's row has one entry.
    pins = sparse.diags_array(PIN * is_long[: A.shape[1]])
    return sparse.block_array(
        [[columns @ short + pins, long.T], [long, -sparse.eye_array(long.shape[0])]], format="csr"
    )


def _check_product(A: sparse.csr_array, transposed: sparse.csr_array, memory: float) -> None:
    """Refuse an A^T A that alone is too large; only where it may be are its entries counted."""
    if MATRIX_ENTRY * np.square(np.diff(A.indptr), dtype=np.float64).sum() <= memory:
        return
    entries = elimination.product_entries(
        *pattern(A), *pattern(transposed), int(memory / MATRIX_ENTRY)
    )
    check_memory(MATRIX_ENTRY * entries, memory)
