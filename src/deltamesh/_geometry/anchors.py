"""Choice of anchors, the vertices whose positions are stored beside the deltas.

`farthest` and `random` follow from integers that the decoder has; it calls them as well, so what
they return for given arguments is part of the format. The greedy choice (`greedy_anchors`) looks at
the geometry: its indices have to be stored.

Farthest points: T. F. Gonzalez, "Clustering to minimize the maximum intercluster distance", Theor.
Comput. Sci. 38, 1985. Generator: G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom
number generators", OOPSLA 2014.
"""

from __future__ import annotations

import operator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.adjacency import lowest
from deltamesh._kernels.mesh import distance
from deltamesh._methods import METHODS
from deltamesh._options import Settings
from deltamesh._shape.surface import Surface
from deltamesh_formats.array_types import Ints, Shorts
from deltamesh_formats.container.layout import FARTHEST, RANDOM

# 0.1 % of the vertices: with the quantization error diffused, more of them buy little.
DEFAULT_FRACTION: Final = 0.001

# Greedy is no default where vertices times anchors are more: 1000 anchors of 50k vertices take some
# 10 s of CPU time.
MOST_GREEDY: Final = 50_000_000

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
    anchors = np.empty(clipped(k, labels), dtype=np.int64)
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
    return np.concatenate((order[at], rest))[: clipped(k, labels)]


def computed(surface: Surface, method: str, k: int, seed: int) -> Ints:
    """Return the anchors that follow from connectivity and seed."""
    if method == RANDOM:
        return random(surface.labels, k, seed)
    return farthest(*surface.graph, surface.labels, k)


def clipped(k: int, labels: Ints) -> int:
    """Return a number of anchors: at least one a component, at most all vertices."""
    components = int(labels.max(initial=-1)) + 1
    return min(max(k, components), len(labels))


def _splitmix64(seed: int, n: int) -> NDArray[np.uint64]:
    """Return the first n outputs of SplitMix64."""
    z = np.uint64(seed) + np.arange(1, n + 1, dtype=np.uint64) * np.uint64(_GAMMA)
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
