"""Greedy choice of anchors: each where the reconstruction from those before it errs most.

O. Sorkine, D. Cohen-Or, "Least-Squares Meshes", SMI 2004: the next anchor goes to the vertex of
largest error; several local maxima a round.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._geometry.anchors import clipped
from deltamesh._geometry.solve import Factor, LeastSquares, factorization
from deltamesh._graph.adjacency import Graph, components, lowest
from deltamesh._kernels.mesh import distance
from deltamesh_formats.array_types import Bools, Floats, Ints

# Solutions for unit vectors kept before the matrix is factored anew, which costs as much as
# some 100 of them. 100k vertices: 100 MB.
MAX_UPDATES: Final = 128
# Candidates a round. A column of a solve for 16 costs half of what a single one costs.
CANDIDATES: Final = 16
# A candidate is taken while its error is at least this share of the largest error anywhere.
# On the bunny, 0.5 to 0.9 and one at a time end at RMS errors within 4 % of each other.
SHARE: Final = 0.7


def greedy(
    graph: Graph,
    vertices: Floats,
    delta: Floats,
    k: int,
    positions: Floats | None = None,
    factor: Factor | None = None,
) -> Ints:
    """Return anchors, each at a vertex where the reconstruction without it errs most, or nearly so.

    It starts with the lowest vertex of each component. A round takes the `CANDIDATES` largest local
    maxima of the error and, while there are any whose error is at least `SHARE` of the largest
    error of all vertices, makes an anchor of the one with the largest. After every one of them the
    reconstruction is brought up to date, so neighbours do not crowd.

    Anchor a is the rank-one update M + e_a e_a^T of the normal equations. With z = M^-1 e_a, the
    reconstruction becomes x + z (p_a - x_a) / (1 + z_a), and the new inverse is M^-1 - w w^T,
    w = z / sqrt(1 + z_a) (Sherman and Morrison). M is factored anew every `MAX_UPDATES` anchors.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
        Neighbour lists, from `adjacency.adjacency`; L is their Laplacian.
    vertices : float64 (n, 3)
        The true positions, against which errors are measured.
    delta : float64 (n, 3)
        What the decoder will have for L @ vertices: quantized, or zero for a least-squares mesh.
    k : int
        The number asked for; the number of components when that is more, n when that is less.
    positions : float64 (n, 3), optional
        What the decoder will have for the position of an anchor. Default: `vertices`.
    factor : callable, optional
        From `deltamesh._geometry.solve.factorization`.

    Returns
    -------
    int64 (k,)
        In the order of selection.

    Raises
    ------
    SolveError
    """
    positions = vertices if positions is None else positions
    factor = factor or factorization(graph)
    labels = components(*graph)
    k = clipped(k, labels)
    anchors = lowest(labels)
    while len(anchors) < k:
        base = factor(anchors)
        count = min(k - len(anchors), MAX_UPDATES)
        chosen = _updates(base, graph, anchors, delta, vertices, positions, count)
        anchors = np.concatenate((anchors, chosen))
    return anchors


def _updates(
    base: LeastSquares,
    graph: Graph,
    anchors: Ints,
    delta: Floats,
    vertices: Floats,
    positions: Floats,
    count: int,
) -> Ints:
    """Return `count` more anchors by updates of one factorization."""
    # One row a coordinate: whatever is done for an anchor goes over whole rows.
    x = np.ascontiguousarray(base.solve(delta, positions[anchors]).T)
    V = np.ascontiguousarray(vertices.T)
    W = np.empty((len(vertices), count))
    chosen: list[int] = []
    free = np.ones(len(vertices), dtype=bool)
    free[anchors] = False
    error = _squared_error(x, V, free)
    while len(chosen) < count:
        candidates = _candidates(graph, error, free, min(CANDIDATES, count - len(chosen)))
        solved = base.solve_normal(_units(candidates, len(vertices)))
        distance.subtract_product(solved, W, len(chosen), candidates)
        solved = np.ascontiguousarray(solved.T)
        first, updates = len(chosen), list[Floats]()
        while len(chosen) < count:
            best = int(np.argmax(error[candidates]))
            a, z = int(candidates[best]), solved[best]
            if not free[a] or error[a] < SHARE**2 * error.max():
                break
            for w in updates:
                z -= w[a] * w
            x += np.outer((positions[a] - x[:, a]) / (1 + z[a]), z)
            updates.append(z / np.sqrt(1 + z[a]))
            chosen.append(a)
            free[a] = False
            error = _squared_error(x, V, free)
        W[:, first : len(chosen)] = np.stack(updates, axis=1)
    return np.array(chosen, dtype=np.int64)


def _candidates(
    graph: Graph,
    error: Floats,
    free: Bools,
    count: int,
) -> Ints:
    """Return the free vertices at the largest local maxima of the error, largest first."""
    is_maximum = np.empty(len(error), dtype=bool)
    distance.local_maxima(*graph, error, is_maximum)
    maxima = np.flatnonzero(is_maximum & free)
    return maxima[np.argsort(-error[maxima], kind="stable")[:count]]


def _squared_error(x: Floats, V: Floats, free: Bools) -> Floats:
    """Return the squared errors, (n,), of x (3, n): -1 at the anchors, which err a little."""
    d = x - V
    return np.where(free, d[0] * d[0] + d[1] * d[1] + d[2] * d[2], -1.0)


def _units(vertices: Ints, n: int) -> Floats:
    b = np.zeros((n, len(vertices)))
    b[vertices, np.arange(len(vertices))] = 1.0
    return b
