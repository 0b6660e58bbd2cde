"""Sparse symmetric matrices, of meshes and of other graphs."""

from __future__ import annotations

import meshes
import numpy as np
import scipy.sparse as sparse
from graphs import laplacian_of

from deltamesh_formats.array_types import Ints


def pattern(matrix: sparse.csr_array) -> tuple[Ints, Ints]:
    """Return where the entries of a matrix are."""
    return matrix.indptr.astype(np.int64), matrix.indices.astype(np.int64)


RNG = np.random.default_rng(4711)


def graph(n: int, edges: Ints) -> sparse.csr_array:
    """Return a diagonally dominant matrix with these edges."""
    i, j = edges.reshape(-1, 2).T
    A = sparse.csr_array((np.ones(len(i)), (i, j)), shape=(n, n))
    return (A + A.T + 2 * n * sparse.eye_array(n)).tocsr()


def squared(V, F) -> sparse.csr_array:
    L = laplacian_of(F, len(V))
    return (L.T @ L + sparse.eye_array(len(V))).tocsr()


def pairs(n: int) -> Ints:
    return np.stack(np.triu_indices(n, 1), axis=1)


GRAPHS = {
    "nothing": graph(0, np.empty(0, dtype=np.int64)),
    "isolated": graph(40, np.empty(0, dtype=np.int64)),
    "path": graph(300, np.stack((np.arange(299), np.arange(1, 300)), axis=1)),
    "star": graph(400, np.stack((np.zeros(399, dtype=np.int64), np.arange(1, 400)), axis=1)),
    "complete": graph(50, pairs(50)),
    "cliques": graph(120, (30 * np.arange(4)[:, None, None] + pairs(30)).reshape(-1, 2)),
    "random": graph(300, RNG.integers(0, 300, (900, 2))),
    "tree": graph(200, np.stack((np.arange(1, 200) // 2, np.arange(1, 200)), axis=1)),
    "torus": squared(*meshes.torus(20, 15)),
    "sphere": squared(*meshes.icosphere(2)),
    "two": squared(*meshes.two_components()),
    "fan": graph(
        301,
        np.concatenate(
            (
                np.stack((np.full(300, 300), np.arange(300)), axis=1),
                np.stack((np.arange(300), np.roll(np.arange(300), 1)), axis=1),
            )
        ),
    ),
}
