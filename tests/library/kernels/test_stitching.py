"""Stitches of a manifold in a stream: any come back, and what cannot be is refused."""

from __future__ import annotations

from collections.abc import Callable

import meshes
import numpy as np
import pytest
import strategies
from hypothesis import given

from deltamesh._graph.adjacency import adjacency
from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._kernels.coding import stitching as kernels
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import Model
from deltamesh._streams.entropy import check_end, decoder, encode_with

MODEL = Model(kernels.SLOTS, kernels.MIXERS)
FACES = meshes.grid(5, 6)[1]
OPPOSITE = pair_halfedges(FACES)
GRAPH = adjacency(FACES, 30)
Code = Callable[[Coder, np.ndarray], object]


def round_trip(code: Code, array: np.ndarray) -> object:
    """Code an array, and again from its stream; return what the decoder says."""
    data = encode_with(MODEL, 1000, lambda coder: code(coder, array.copy()))
    coder, out = decoder(data, *MODEL), np.zeros_like(array)
    result = code(coder, out)
    check_end(coder, 0)
    np.testing.assert_array_equal(out, array)
    return result


@given(strategies.SMALL)
def test_points_of_vertices_come_back(seed: int) -> None:
    """Vertices at one point that are no neighbours, as a cut makes them."""
    rng, points = np.random.default_rng(seed), np.full(30, -1)
    count = 0
    for v in range(30):
        around = {int(points[u]) for u in GRAPH[1][GRAPH[0][v] : GRAPH[0][v + 1]] if u < v}
        beside = {
            int(points[w])
            for u in GRAPH[1][GRAPH[0][v] : GRAPH[0][v + 1]]
            for w in GRAPH[1][GRAPH[0][u] : GRAPH[0][u + 1]]
            if w < v
        }
        free = sorted(set(range(count)) - around - beside)
        if free and rng.random() < 0.4:
            points[v] = rng.choice(free)
        else:
            points[v], count = count, count + 1
    boundary = np.zeros(30, dtype=bool)
    boundary[FACES.ravel()[OPPOSITE < 0]] = True
    found = round_trip(lambda c, a: kernels.code_stitches(c, *GRAPH, boundary, a), points)
    assert found == count


@given(strategies.SMALL)
def test_reversed_faces_come_back(seed: int) -> None:
    flags = np.random.default_rng(seed).random(len(FACES)) < 0.3
    round_trip(lambda c, a: kernels.code_reversed(c, OPPOSITE, a), flags)


@given(strategies.SMALL)
def test_repeated_faces_come_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    repeats = rng.integers(0, 4, (len(FACES), 2)) * (rng.random((len(FACES), 2)) < 0.2)
    total = int(repeats.sum())
    assert round_trip(lambda c, a: kernels.code_repeats(c, OPPOSITE, a, total), repeats)


def test_fewer_repeats_than_announced_are_noticed() -> None:
    repeats = np.zeros((1, 2), dtype=np.int64)
    data = encode_with(MODEL, 9, lambda c: kernels.code_repeats(c, OPPOSITE[:3], 0 * repeats, 5))
    assert not kernels.code_repeats(decoder(data, *MODEL), OPPOSITE[:3], repeats, 5)
    assert not repeats.any()


@given(strategies.SMALL)
def test_degenerate_faces_come_back(seed: int) -> None:
    rng = np.random.default_rng(seed)
    pairs = rng.integers(0, 35, (int(rng.integers(0, 9)), 2))  # five points are isolated
    pairs = pairs[np.lexsort(pairs.T[::-1])]
    assert round_trip(lambda c, a: kernels.code_degenerate(c, *GRAPH, a, 35), pairs)


@pytest.mark.parametrize("n", [30, 33])
def test_degenerate_faces_beyond_the_points_are_refused(n: int) -> None:
    pairs = np.array([[2, 3], [34, 1]])
    data = encode_with(
        MODEL, 9, lambda coder: kernels.code_degenerate(coder, *GRAPH, pairs.copy(), 35)
    )
    out = np.zeros_like(pairs)
    assert not kernels.code_degenerate(decoder(data, *MODEL), *GRAPH, out, n)
