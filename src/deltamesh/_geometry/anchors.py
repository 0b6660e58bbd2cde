"""Choice of anchors, the vertices whose positions are stored beside the deltas.

`farthest` and `random` follow from integers that the decoder has; it calls them as well, so what
they return for given arguments is part of the format. `greedy` looks at the geometry: its indices
have to be stored.

Sources: O. Sorkine, D. Cohen-Or, "Least-Squares Meshes", SMI 2004 (greedy: the next anchor goes to
the vertex of largest error; several local maxima a round). Farthest points: T. F. Gonzalez,
"Clustering to minimize the maximum intercluster distance", Theor. Comput. Sci. 38, 1985. Generator:
G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014.
"""

from __future__ import annotations

import operator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._geometry.solve import Factor, LeastSquares, factorization
from deltamesh._graph.adjacency import Graph, components, lowest
from deltamesh._kernels.mesh import distance
from deltamesh._methods import METHODS
from deltamesh._options import Settings
from deltamesh_formats.array_types import Bools, Floats, Ints, Shorts
from deltamesh_formats.container.layout import FARTHEST

# 0.1 % of the vertices: with the quantization error diffused, more of them buy little.
DEFAULT_FRACTION: Final = 0.001

# Greedy is no default where vertices times anchors are more: 1000 anchors of 50k vertices take some
# 10 s of CPU time.
MOST_GREEDY: Final = 50_000_000
# Greedy: solutions for unit vectors kept before the matrix is factored anew, which costs as much as
# some 100 of them. 100k vertices: 100 MB.
MAX_UPDATES: Final = 128
# Greedy: candidates a round. A column of a solve for 16 costs half of what a single one costs.
CANDIDATES: Final = 16
# Greedy: a candidate is taken while its error is at least this share of the largest error anywhere.
# On the bunny, 0.5 to 0.9 and one at a time end at RMS errors within 4 % of each other.
SHARE: Final = 0.7

_GAMMA: Final = 0x9E3779B97F4A7C15


def count_anchors(anchors: int | float | None, n: int, components: int) -> int:
    """Return the number of anchors to choose.

    Parameters
    ----------
    anchors : int, float or None
        A count from 1, or a fraction of the vertices in the open interval (0, 1), rounded to
        nearest. None: `DEFAULT_FRACTION`.
    n, components : int
        Vertices and connected components of the mesh.

    Returns
    -------
    int
        At least one for each component, at most n.

    Raises
    ------
    ValueError
        For anything else.
    """
    if anchors is None:
        anchors = DEFAULT_FRACTION
    if isinstance(anchors, (float, np.floating)):
        if not 0 < anchors < 1:
            raise ValueError(f"anchors as a fraction must lie between 0 and 1, not {anchors}")
        count = round(float(anchors) * n)
    else:
        try:
            count = operator.index(anchors)
        except TypeError:
            raise ValueError(f"anchors must be a count or a fraction, not {anchors!r}") from None
        if isinstance(anchors, bool) or count < 1:
            raise ValueError(f"anchors as a count must be 1 or more, not {anchors!r}")
    return min(max(count, components), n)


def method_of(settings: Settings, n: int, components: int, k: int) -> str:
    """Return the choice that settings ask for or, if none, the default for k of n vertices.

    Greedy looks at errors of least squares. The default are the farthest where anchors are
    interpolated, where there is too much to do, and where there is no choice.
    """
    if settings.anchor_method is not None:
        return settings.anchor_method
    may_pay = not settings.interpolated and k > components and n * k <= MOST_GREEDY
    return METHODS[settings.method].anchor_method if may_pay else FARTHEST


def farthest(indptr: Shorts, indices: Shorts, labels: Ints, k: int) -> Ints:
    """Return anchors by farthest-point sampling in the graph.

    First the lowest vertex of each component, in the order of the labels; then, again and again,
    the vertex with the most edges on the shortest path to its nearest anchor, the lowest of equals.

    Parameters
    ----------
    indptr : int32 (n + 1,)
    indices : int32 (2 e,)
        Neighbour lists, from `adjacency.adjacency`.
    labels : int64 (n,)
        From `adjacency.components`.
    k : int
        The number asked for; the number of components when that is more, n when that is less.

    Returns
    -------
    int64 (k,)
        In the order of selection.
    """
    first = lowest(labels)
    anchors = np.empty(_clipped(k, labels), dtype=np.int64)
    distance.farthest_points(indptr, indices, first, anchors)
    return anchors


def random(labels: Ints, k: int, seed: int) -> Ints:
    """Return random anchors, a function of the arguments that is the same everywhere.

    Vertex i gets the 64-bit key SplitMix64(seed)[i], the output number i (from 0) of that generator
    when its state starts as the seed:
    z = seed + (i + 1) * 0x9E3779B97F4A7C15; z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9;
    z = (z ^ z >> 27) * 0x94D049BB133111EB; key = z ^ z >> 31, all modulo 2**64.
    First comes the vertex of lowest (key, index) of each component, in the order of the labels,
    then the others in ascending order of (key, index).

    Parameters
    ----------
    labels : int64 (n,)
        From `adjacency.components`.
    k : int
        The number asked for; the number of components when that is more, n when that is less.
    seed : int
        In [0, 2**64).

    Returns
    -------
    int64 (k,)
        Without repetition, in the order of selection.
    """
    order = np.argsort(_splitmix64(seed, len(labels)), kind="stable").astype(np.int64)
    _, at = np.unique(labels[order], return_index=True)
    rest = np.delete(order, at)
    return np.concatenate((order[at], rest))[: _clipped(k, labels)]


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
    k = _clipped(k, labels)
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


def _clipped(k: int, labels: Ints) -> int:
    components = int(labels.max(initial=-1)) + 1
    return min(max(k, components), len(labels))


def _splitmix64(seed: int, n: int) -> NDArray[np.uint64]:
    """Return the first n outputs of SplitMix64."""
    z = np.uint64(seed) + np.arange(1, n + 1, dtype=np.uint64) * np.uint64(_GAMMA)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
