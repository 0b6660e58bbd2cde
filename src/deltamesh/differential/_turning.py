"""Rotations of the neighbourhoods of a surface, and deltas that turn with them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numpy.typing import ArrayLike

from deltamesh._geometry import rotations
from deltamesh.differential._graphs import graph_of, numbers_of, rows_of
from deltamesh_formats.arguments import require_whole
from deltamesh_formats.array_types import Floats
from deltamesh_formats.errors import OptionError

if TYPE_CHECKING:
    from deltamesh.differential._graphs import Sparse


def fitted_rotations(L: Sparse, before: ArrayLike, after: ArrayLike, rings: int = 0) -> Floats:
    """Return the rotation that best takes the edges at each vertex from one surface to another.

    O. Sorkine, M. Alexa, "As-rigid-as-possible surface modeling", SGP 2007.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    before, after : float array (n, 3)
    rings : int
        How many edges away the edges of other vertices count, too.

    Returns
    -------
    float64 (n, 3, 3)
        Matrices R with R (a_j - a_i) near b_j - b_i, for the neighbours j of vertex i. Where edges
        determine no single rotation, a mean of those that are equally good.

    Raises
    ------
    OptionError
        If the shapes do not agree, or a number is not finite.
    """
    require_whole("rings", rings, 0)
    graph = graph_of(L)
    n = len(graph[0]) - 1
    old, new = rows_of(before, n, "vertices before", 3), rows_of(after, n, "vertices after", 3)
    return rotations.fit(graph, old, new, rings)


def nearest_rotations(matrices: ArrayLike) -> Floats:
    """Return the rotation that is nearest to each matrix (k, 3, 3), float64 (k, 3, 3).

    Matrices are of about the size of rotations, such as those that a Laplacian blends.
    """
    return rotations.nearest(_matrices(matrices))


def turned_deltas(L: Sparse, vertices: ArrayLike, matrices: ArrayLike) -> Floats:
    """Return the deltas of a surface whose neighbourhoods have turned.

    Those of vertex i are the sum of (R_i + R_j) (v_i - v_j) / 2 over its neighbours j: the second
    system of Y. Lipman, O. Sorkine, D. Levin, D. Cohen-Or, "Linear rotation-invariant coordinates
    for meshes", SIGGRAPH 2005.

    Parameters
    ----------
    L : csr_array (n, n)
    vertices : float array (n, 3)
    matrices : float array (n, 3, 3)

    Returns
    -------
    float64 (n, 3)

    Raises
    ------
    OptionError
        If the shapes do not agree, or a number is not finite.
    """
    graph = graph_of(L)
    V, R = rows_of(vertices, len(graph[0]) - 1, "vertices", 3), _matrices(matrices)
    if len(R) != len(V):
        raise OptionError(f"there are {len(R)} matrices for {len(V)} vertices")
    return rotations.turned_deltas(graph, V, R)


def _matrices(given: ArrayLike) -> Floats:
    array = numbers_of(given, "matrices")
    if array.ndim != 3 or array.shape[1:] != (3, 3):
        raise OptionError(f"matrices have shape {array.shape}, not (k, 3, 3)")
    return rows_of(array.reshape(-1, 9), len(array), "matrices").reshape(-1, 3, 3)
