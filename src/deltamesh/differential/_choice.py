"""Choice of anchors on a Laplacian."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from deltamesh._geometry import anchors as choice
from deltamesh._geometry.greedy_anchors import greedy
from deltamesh._graph.adjacency import components
from deltamesh._options import MAX_SEED
from deltamesh.differential._graphs import graph_of, rows_of
from deltamesh_formats.arguments import require_whole
from deltamesh_formats.array_types import Ints

if TYPE_CHECKING:
    from deltamesh.differential._graphs import Sparse


def farthest_anchors(L: Sparse, k: int) -> Ints:
    """Return anchors that are far apart: each the vertex with the most edges to those before it.

    T. F. Gonzalez, "Clustering to minimize the maximum intercluster distance", Theor. Comput. Sci.
    38, 1985. The first are the lowest vertices of the components. A decoder finds the same, so that
    they take no bytes.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    k : int
        The number asked for; as many as components when that is more, n when that is less.

    Returns
    -------
    int64 (k,)
        In the order of selection.

    Raises
    ------
    OptionError
        If L is no Laplacian, or k is no number of vertices.
    """
    graph = graph_of(L)
    require_whole("k", k, 0)
    return choice.farthest(*graph, components(*graph), k)


def random_anchors(L: Sparse, k: int, seed: int = 0) -> Ints:
    """Return random anchors, the lowest keys of SplitMix64 from a seed in [0, 2^64).

    The first are one of each component. L, k and the result are as of `farthest_anchors`.
    """
    require_whole("k", k, 0)
    require_whole("seed", seed, 0, MAX_SEED)
    return choice.random(components(*graph_of(L)), k, seed)


def greedy_anchors(L: Sparse, vertices: ArrayLike, k: int, delta: ArrayLike | None = None) -> Ints:
    """Return anchors each of which is where the solution with those before it errs most, or nearly.

    O. Sorkine, D. Cohen-Or, "Least-Squares Meshes", SMI 2004: several local maxima of the error a
    round; here by rank-one updates of one factorization. The first m of k anchors are those that
    m anchors would be, but for the last round.

    Parameters
    ----------
    L : csr_array (n, n)
        From `laplacian`.
    vertices : float array (n, 3)
        Where errors are measured from.
    k : int
        As for `farthest_anchors`.
    delta : float array (n, 3), optional
        What the decoder has for L x. Default: 0, as for a least-squares mesh.

    Returns
    -------
    int64 (k,)
        In the order of selection.

    Raises
    ------
    OptionError
        If the shapes do not agree, or k is no number of vertices.
    SolveError
    """
    graph = graph_of(L)
    require_whole("k", k, 0)
    V = rows_of(vertices, len(graph[0]) - 1, "vertices", 3)
    rows = np.zeros_like(V) if delta is None else rows_of(delta, len(V), "deltas", 3)
    return greedy(graph, V, rows, k)
