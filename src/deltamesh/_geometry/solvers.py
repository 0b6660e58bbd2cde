"""Sparse direct solvers of symmetric quasidefinite systems, behind one signature.

rslab does not survive a fork: its threads stay in the parent and its child waits for them for ever,
with one thread too. The allocator that comes with it belongs to a thread that may not be in the
child either. A process that was forked from one that had loaded rslab goes by SuperLU of scipy
instead. MKL starts its threads anew in a child.
"""

from __future__ import annotations

import contextlib
import importlib
import importlib.util
import os
import sys
import threading
import weakref
from collections.abc import Callable, Iterator, Mapping
from ctypes import c_int
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from deltamesh_formats.array_types import Floats
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
        Factors a matrix, csr_array (n, n), with a number of threads.
    """

    module: str
    requirement: str
    factor: Callable[[sparse.csr_array, int], Solve]


# Whether a process that this one was forked from had loaded rslab.
_inherited = False


def _after_fork() -> None:
    global _inherited
    _inherited = "rslab" in sys.modules


if hasattr(os, "register_at_fork"):  # not on Windows, which has no fork
    os.register_at_fork(after_in_child=_after_fork)


def solver_name(name: str) -> str:
    """Return the name of an installed solver; "auto" becomes the preferred one.

    Raises
    ------
    SolveError
        If there is none of this name, it is not installed (the message says how to install it), or
        it does not work in this process.
    """
    if name == "auto":
        return "rslab" if _installed("rslab") and not _inherited else "scipy"
    if name not in SOLVERS:
        raise SolveError(f"unknown solver {name!r}: choose auto, {', '.join(SOLVERS)}")
    solver = SOLVERS[name]
    if not _installed(solver.module):
        raise SolveError(f'solver {name!r} is not installed: pip install "{solver.requirement}"')
    if name == "rslab" and _inherited:
        raise SolveError(
            "solver 'rslab' does not work in a process forked from one that has loaded it:"
            " choose scipy, or start processes by spawn"
        )
    return name


def _installed(module: str) -> bool:
    return importlib.util.find_spec(module) is not None


def _rslab() -> Any:
    """Import rslab in a thread that lives as long as the process.

    Its allocator (mimalloc, in rslab 1.7) belongs to the thread that loads the library and crashes
    the process in the next thread, once that thread has ended.
    """
    if "rslab" not in sys.modules and threading.current_thread() is not threading.main_thread():
        loaded = threading.Event()

        def load() -> None:
            try:
                importlib.import_module("rslab")
            finally:
                loaded.set()
            threading.Event().wait()

        threading.Thread(target=load, name="rslab-allocator", daemon=True).start()
        loaded.wait()
    return importlib.import_module("rslab")


def _factor_rslab(matrix: sparse.csr_array, threads: int) -> Solve:
    rslab = _rslab()
    # amf: half the time of metis on meshes of 35k to 540k vertices, 3-8 % more memory.
    factor = rslab.ldlt(matrix, ordering="amf", scaling="none", threads=threads)
    return lambda b: np.asarray(factor.solve_many(np.ascontiguousarray(b)))


def _factor_pardiso(matrix: sparse.csr_array, threads: int) -> Solve:
    import pypardiso
    import scipy.sparse as sparse

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


def _factor_scipy(matrix: sparse.csr_array, threads: int) -> Solve:
    from scipy.sparse.linalg import splu

    factor = splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.01,  # the diagonal, unless a long row makes it tiny
        options={"SymmetricMode": True},
    )
    return lambda b: np.asarray(factor.solve(np.ascontiguousarray(b)))


SOLVERS: Final[Mapping[str, Solver]] = {
    "rslab": Solver("rslab", "rslab", _factor_rslab),
    "pardiso": Solver("pypardiso", "deltamesh[mkl]", _factor_pardiso),
    "scipy": Solver("scipy", "scipy", _factor_scipy),
}
