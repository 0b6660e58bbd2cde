"""Normal equations of differential coordinates and anchors, factored: A^T A for A = [L; W S].

Long rows become unknowns of their own: see `_quasidefinite`.
"""

from __future__ import annotations

import contextlib
import math
from typing import TYPE_CHECKING, cast

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
from deltamesh._graph.adjacency import Graph
from deltamesh._graph.laplacian import laplacian
from deltamesh._kernels.mesh import elimination
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import LimitError, SolveError

if TYPE_CHECKING:
    import scipy.sparse as sparse

# A row of L with d entries puts d^2 entries into L^T L: one vertex with 50 000 neighbours would ask
# for 20 GB. Longer rows become unknowns of their own, see `_quasidefinite`.
LONGEST_ROW = 100

# Weight of the pins of `_quasidefinite`: far above rounding, far below the weight 1 of an anchor.
PIN = 1e-5


def factored(
    graph: Graph, anchors: Ints, solver: str, threads: int, memory: float, weights: Floats
) -> Solve:
    """Return a function that solves A^T A x = b, for A = [L; W S].

    Raises
    ------
    LimitError, SolveError
    """
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
