"""Spectra: eigenvectors of a Laplacian, and the energy of rows at its vertices by frequency."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._geometry.solvers import SOLVERS, solver_name
from deltamesh._machine import available_cores
from deltamesh.differential._graphs import graph_of, numbers_of, rows_of
from deltamesh_formats.arguments import require_whole
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh.differential._graphs import Sparse

# How far below 0, the lowest eigenvalue, inverse iteration looks from: L itself is singular.
SHIFT: Final = 1e-8


def eigenvectors(L: Sparse, k: int | None = None) -> tuple[Floats, Floats]:
    """Return eigenvalues and orthonormal eigenvectors of a Laplacian, from the smooth ones on.

    Z. Karni, C. Gotsman, "Spectral compression of mesh geometry", SIGGRAPH 2000, take the lowest k
    as a basis. All of them are found by LAPACK, in time n^3; some by ARPACK, with inverses of L
    moved by 1e-8.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    k : int, optional
        The number of the lowest ones. Default: all n.

    Returns
    -------
    values : float64 (k,)
        Ascending; the first is 0, but for rounding.
    vectors : float64 (n, k)
        In columns. Signs, and bases of equal eigenvalues, are arbitrary.

    Raises
    ------
    OptionError
        If L is no Laplacian, or k is not in 1 to n.
    """
    graph_of(L)
    n = L.shape[0]
    if k is not None:
        require_whole("k", k, 1, n)
    if k is None or k > n // 2:
        values, vectors = np.linalg.eigh(L.toarray())
        return values[:k], vectors[:, :k]
    import scipy.sparse as sparse
    from scipy.sparse.linalg import LinearOperator, eigsh

    matrix = (L + SHIFT * sparse.eye_array(n)).tocsr()
    inverse = SOLVERS[solver_name("auto")].factor(matrix, available_cores(), math.inf)
    operator = LinearOperator(
        (n, n), matvec=lambda b: inverse(b.reshape(-1, 1))[:, 0], dtype=np.float64
    )
    start = np.ones(n)  # not random: the same result each time
    start[::2] += 0.5
    values, vectors = eigsh(L, k, sigma=-SHIFT, OPinv=operator, v0=start)
    order = np.argsort(values)
    return np.asarray(values[order]), np.asarray(vectors[:, order])


def energies(vectors: Floats, x: ArrayLike) -> Floats:
    """Return the energy of rows x (n, c), such as errors, at each frequency, float64 (k,).

    It is |u_j^T x|^2 for each eigenvector u_j, summed over the columns; over all eigenvectors they
    sum to |x|^2.

    Raises
    ------
    OptionError
        If the shapes do not agree.
    """
    basis = rows_of(vectors, None, "eigenvectors")
    rows = rows_of(x, len(basis), "rows")
    return np.asarray(((basis.T @ rows) ** 2).sum(axis=1))


def spectral_slope(values: Floats, energy: Floats) -> float:
    """Return the exponent p of energy ~ values^p: the slope of a line through all logarithms.

    Of noise that is white before a filter, each logarithm is off by the same in the mean, and the
    slope is that of the filter.

    Parameters
    ----------
    values, energy : float array (k,)
        Eigenvalues, and energies at them, positive but for the first, which is left out.

    Raises
    ------
    OptionError
        If they are not that, or fewer than three.
    """
    x, y = numbers_of(values, "values"), numbers_of(energy, "energies")
    if x.ndim != 1 or x.shape != y.shape or len(x) < 3:
        raise OptionError(f"values and energies have shapes {x.shape} and {y.shape}, not (k,)")
    if not ((x[1:] > 0) & (y[1:] > 0) & np.isfinite(x[1:]) & np.isfinite(y[1:])).all():
        raise OptionError("a value or an energy, after the first, is no positive number")
    return float(np.polyfit(np.log(x[1:]), np.log(y[1:]), 1)[0])
