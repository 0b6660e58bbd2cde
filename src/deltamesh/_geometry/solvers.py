"""Sparse direct solvers of symmetric quasidefinite systems, behind one signature.

A process that was forked from one that had loaded rslab goes by SuperLU of scipy instead
(`rslab_loading`). MKL starts its threads anew in a child.

Each foresees its memory before it computes a number (`fill`).
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import math
import weakref
from collections.abc import Callable, Iterator, Mapping
from ctypes import c_int
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np

from deltamesh._geometry.fill import (
    CORE_ENTRY,
    FACTOR_ENTRY,
    MATRIX_ENTRY,
    MOST,
    SUPERLU_ENTRY,
    check_breadth,
    check_fill,
    check_memory,
    entries_within,
    pattern,
)
from deltamesh._geometry.rslab_loading import is_inherited, load_rslab
from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.mesh import elimination, factor, laplacian
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.errors import SolveError

if TYPE_CHECKING:
    import scipy.sparse as sparse

# From the right-hand sides, float64 (n, c), to the solutions.
Solve = Callable[[Floats], Floats]


@dataclass(frozen=True)
class Solver:
    """A solver that may be installed.

    Attributes
    ----------
    module, requirement : str
        What is imported, and what pip installs.
    factor : callable
        Factors a matrix, csr_array (n, n), with a number of threads, within bytes of memory;
        raises LimitError where they are not enough.
    """

    module: str
    requirement: str
    factor: Callable[[sparse.csr_array, int, float], Solve]


# Unknowns and entries of the factor up to which the core takes no more CPU time than rslab, even
# without the 0.2 s that its imports take.
SMALL: Final = 50_000
SMALL_FACTOR: Final = 8_000_000


def solver_name(name: str) -> str:
    """Return the name of an installed solver; "auto" becomes the preferred one for large systems.

    Raises
    ------
    SolveError
        If there is none of this name, it is not installed (the message says how to install it), or
        it does not work in this process.
    """
    if name == "auto":
        return "rslab" if _installed("rslab") and not is_inherited() else "scipy"
    if name not in SOLVERS:
        raise SolveError(f"unknown solver {name!r}: choose auto, {', '.join(SOLVERS)}")
    solver = SOLVERS[name]
    if not _installed(solver.module):
        raise SolveError(f'solver {name!r} is not installed: pip install "{solver.requirement}"')
    if name == "rslab" and is_inherited():
        raise SolveError(
            "solver 'rslab' does not work in a process forked from one that has loaded it:"
            " choose scipy, or start processes by spawn"
        )
    return name


def _installed(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


def factor_normal(
    graph: Graph, anchors: Ints, squares: Floats, memory: float, most: int = MOST
) -> Solve | None:
    """Return the core's solver of the normal equations, for which nothing is imported.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
        Neighbour lists of vertices of which none has very many.
    anchors : int64 (k,)
    squares : float64 (k,)
        Of the weights of the anchors, finite.
    memory : float
        Bytes that the factorization may take.
    most : int
        Entries of the factor, above which None is returned.

    Raises
    ------
    LimitError
    ArithmeticError
        If a pivot is zero.
    """
    bounds = laplacian.normal_bounds(*graph)
    if bounds[-1] > 2 * most:  # it has both triangles
        return None
    check_memory(CORE_ENTRY * int(bounds[-1]), memory)
    rows = laplacian.normal_matrix(*graph, anchors, bounds, squares)
    return _factor_rows(*rows, memory, most)


def _factor_core(matrix: sparse.csr_array, threads: int, memory: float) -> Solve:
    return cast(Solve, _factor_rows(*pattern(matrix), matrix.data, memory))


def _factor_rows(
    indptr: Ints, indices: Ints, values: Floats, memory: float, most: int = MOST
) -> Solve | None:
    """Factor a matrix whose rows are given, unless the factor has more than `most` entries."""
    most = min(most, entries_within(memory))
    check_breadth(indptr, indices, FACTOR_ENTRY, min(memory, FACTOR_ENTRY * most))
    plan = factor.plan(indptr, indices, elimination.minimum_degree(indptr, indices), most)
    if plan is None:
        check_memory(FACTOR_ENTRY * (most + 1), memory)
        return None
    check_memory(CORE_ENTRY * len(indices) + plan.memory, memory)
    return factor.Factor(plan, indptr, indices, values).solve


def _factor_rslab(matrix: sparse.csr_array, threads: int, memory: float) -> Solve:
    rslab = load_rslab()
    check_breadth(*pattern(matrix), FACTOR_ENTRY, memory)
    # amf: half the time of metis on meshes of 35k to 540k vertices, 3-8 % more memory.
    analysis = rslab.analyze(matrix, path="ldlt", ordering="amf", scaling="none", threads=threads)
    # A thread more takes as much for a small matrix as for a large one: some stack.
    plan = analysis.memory_plan(nrhs=3, threads=1)
    check_memory(MATRIX_ENTRY * matrix.nnz + plan["peak_bytes"], memory)
    factor = analysis.factor(matrix, threads=threads)
    return lambda b: np.asarray(factor.solve_many(np.ascontiguousarray(b)))


def _factor_pardiso(matrix: sparse.csr_array, threads: int, memory: float) -> Solve:
    import pypardiso
    import scipy.sparse as sparse

    if memory < math.inf:  # MKL dissects, too
        places = pattern(matrix)
        check_fill(*places, elimination.dissect(*places), FACTOR_ENTRY, memory)
    upper = sparse.csr_matrix(sparse.triu(matrix))
    solver = pypardiso.PyPardisoSolver(mtype=-2)  # real, symmetric, indefinite
    with _mkl_threads(solver, threads):
        solver.factorize(upper)

    def solve(b: Floats) -> Floats:
        with _mkl_threads(solver, threads):
            return np.asarray(solver.solve(upper, b))

    # MKL keeps the factors in memory of its own.
    weakref.finalize(solve, solver.free_memory, everything=True)
    return solve


@contextlib.contextmanager
def _mkl_threads(solver: Any, threads: int) -> Iterator[None]:
    """Set the number of threads that MKL uses when called from this thread."""
    previous = solver.libmkl.MKL_Set_Num_Threads_Local(c_int(threads))
    try:
        yield
    finally:
        solver.libmkl.MKL_Set_Num_Threads_Local(c_int(previous))


def _minimum_degree(matrix: sparse.csr_array) -> Ints:
    """Return the order of SuperLU, which has it from an incomplete factor of hardly any entries."""
    from scipy.sparse.linalg import spilu

    factor = spilu(
        matrix.tocsc(),
        drop_tol=math.inf,
        fill_factor=1,
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    return np.argsort(factor.perm_c)


def _factor_scipy(matrix: sparse.csr_array, threads: int, memory: float) -> Solve:
    from scipy.sparse.linalg import splu

    check_breadth(*pattern(matrix), SUPERLU_ENTRY, memory)
    order = _minimum_degree(matrix)
    check_fill(*pattern(matrix), order, SUPERLU_ENTRY, memory)
    factor = splu(
        matrix[order][:, order].tocsc(),
        permc_spec="NATURAL",
        diag_pivot_thresh=0.01,  # the diagonal, unless a long row makes it tiny
        options={"SymmetricMode": True},
    )

    def solve(b: Floats) -> Floats:
        x = np.empty_like(b)
        x[order] = factor.solve(np.ascontiguousarray(b[order]))
        return x

    return solve


SOLVERS: Final[Mapping[str, Solver]] = {
    "core": Solver("deltamesh", "deltamesh", _factor_core),
    "rslab": Solver("rslab", "rslab", _factor_rslab),
    "pardiso": Solver("pypardiso", "deltamesh[mkl]", _factor_pardiso),
    "scipy": Solver("scipy", "scipy", _factor_scipy),
}
