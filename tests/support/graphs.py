"""The graph of faces, by the functions that the codec calls one after the other."""

from __future__ import annotations

import importlib.util

import numpy as np
import scipy.sparse as sparse

from deltamesh._geometry.solve import LeastSquares
from deltamesh._graph.adjacency import adjacency, components
from deltamesh._graph.halfedges import weld
from deltamesh._graph.laplacian import laplacian
from deltamesh._measures.metrics import diagonal
from deltamesh_formats.array_types import Floats, Ints

# Those that an installation has without extras.
FREE_SOLVERS = (
    "core",
    *(name for name in ("rslab", "scipy") if importlib.util.find_spec(name)),
)


def laplacian_of(faces: Ints, n: int) -> sparse.csr_array:
    return laplacian(*adjacency(faces, n))


def graph_of(L: sparse.csr_array) -> tuple[Ints, Ints]:
    """The neighbour lists of a Laplacian."""
    A = L - sparse.diags_array(L.diagonal())
    A = sparse.csr_array(A)
    A.eliminate_zeros()
    A.sort_indices()
    return A.indptr.astype(np.int64), A.indices.astype(np.int64)


def components_of(faces: Ints, n: int) -> Ints:
    return components(*adjacency(faces, n))


def least_squares(
    L: sparse.csr_array,
    anchors: Ints,
    delta: Floats,
    positions: Floats,
    solver: str = "auto",
    threads: int | None = None,
) -> Floats:
    return LeastSquares(graph_of(L), anchors, solver, threads).solve(delta, positions)


def tolerances(V: Floats, F: Ints) -> Floats:
    """By how much positions may differ, by vertex (n, 1): SPEC.md 5.4, with rounding."""
    labels = components_of(F, len(V))
    diagonals = np.array([diagonal(V[labels == k]) for k in range(labels.max(initial=-1) + 1)])
    rounding = 4 * np.spacing(np.abs(V).max(axis=1, initial=0))
    return (1e-9 * diagonals[labels] + rounding)[:, None]


def points_of(V: Floats, F: Ints) -> tuple[Ints, int]:
    """The faces over distinct positions, and how many there are of these."""
    keep, welded = weld(V)
    return welded[F], len(keep)
