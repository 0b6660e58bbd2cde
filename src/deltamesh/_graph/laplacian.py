"""Combinatorial Laplacian L = D - A of a graph, as a sparse matrix.

Source: O. Sorkine, D. Cohen-Or, S. Toledo, "High-Pass Quantization for Mesh Encoding", SGP 2003,
section 3.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from deltamesh_formats.array_types import Shorts

if TYPE_CHECKING:
    import scipy.sparse as sparse


def laplacian(indptr: Shorts, indices: Shorts) -> sparse.csr_array:
    """Return L: the degree of vertex i on the diagonal, -1 for each of its neighbours.

    Parameters
    ----------
    indptr, indices : int32 (n + 1,), (2 e,)
        Neighbour lists, from `adjacency.adjacency`.

    Returns
    -------
    csr_array, float64 (n, n)
        Symmetric, with sorted indices. The row of an isolated vertex is empty.
    """
    import scipy.sparse as sparse  # 0.2 s, which files without a system need not wait for

    n = len(indptr) - 1
    A = sparse.csr_array((np.ones(len(indices)), indices, indptr), shape=(n, n))
    L = (sparse.diags_array(np.diff(indptr).astype(np.float64)) - A).tocsr()
    L.sort_indices()
    return L
