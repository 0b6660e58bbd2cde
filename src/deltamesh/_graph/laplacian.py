"""The combinatorial Laplacian L = D - A of a graph, as a sparse matrix."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sparse
from numpy.typing import NDArray

from deltamesh._graph.adjacency import adjacency


def graph_laplacian(faces: NDArray[np.int64], n: int) -> sparse.csr_array:
    """Return L = D - A: the degree of vertex i on the diagonal, -1 for each of its neighbours.

    Parameters
    ----------
    faces : int64 (m, 3)
    n : int

    Returns
    -------
    csr_array, float64 (n, n)
        Symmetric, with sorted indices. The row of an isolated vertex is one stored zero.
    """
    return adjacency_laplacian(*adjacency(faces, n))


def adjacency_laplacian(indptr: NDArray[np.int64], indices: NDArray[np.int64]) -> sparse.csr_array:
    """Return `graph_laplacian` of a graph whose neighbour lists exist already."""
    n = len(indptr) - 1
    A = sparse.csr_array((np.ones(len(indices)), indices, indptr), shape=(n, n))
    L = (sparse.diags_array(np.diff(indptr).astype(np.float64)) - A).tocsr()
    L.sort_indices()
    return L
