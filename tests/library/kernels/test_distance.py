"""Distances along edges, and the linear algebra of greedy anchors."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._graph import adjacency as laplacian
from deltamesh._kernels.mesh import distance


def test_subtract_product_equals_numpy() -> None:
    rng = np.random.default_rng(17)
    W, block = rng.normal(size=(50, 6)), rng.normal(size=(50, 3))
    rows = np.array([4, 0, 31])
    expected = block - W[:, :5] @ W[rows, :5].T
    distance.subtract_product(block, W, 5, rows)
    np.testing.assert_allclose(block, expected, rtol=1e-12)


def test_local_maxima_break_ties_by_index() -> None:
    F = np.array([[0, 1, 2], [2, 1, 3]])
    found = np.empty(4, dtype=bool)
    distance.local_maxima(*laplacian.adjacency(F, 4), np.array([1.0, 1, 0, 1]), found)
    assert found.tolist() == [True, False, False, False]


@strategies.SOME
@given(strategies.surfaces(), st.integers(0, 2**32), st.floats(0, 1))
def test_the_nearest_source(mesh: meshes.Arrays, seed: int, share: float) -> None:
    n, rng = len(mesh[0]), np.random.default_rng(seed)
    sources = rng.permutation(n)[: round(share * n)]
    found = distance.nearest(*laplacian.adjacency(mesh[1], n), sources)
    L = oracle.laplacian(mesh[1], n)
    assert found.tolist() == poisson_oracle.nearest(L, sources.tolist())
    away = np.array(oracle.graph_distances(L, sources.tolist()))
    for v in np.flatnonzero(found >= 0):
        assert oracle.graph_distances(L, [sources[found[v]]])[v] == away[v]
    assert ((found < 0) == (away == n)).all()


def test_of_equally_near_sources_the_earlier_one_has_the_vertex() -> None:
    graph = laplacian.adjacency(np.array([[0, 1, 2], [2, 1, 3], [4, 5, 6]]), 8)
    assert distance.nearest(*graph, np.array([3, 0])).tolist() == [1, 0, 0, 0, -1, -1, -1, -1]
    assert distance.nearest(*graph, np.array([0, 3, 7])).tolist() == [0, 0, 0, 1, -1, -1, -1, 2]
    assert distance.nearest(*graph, np.zeros(0, dtype=np.int64)).tolist() == [-1] * 8


@pytest.mark.parametrize("sources", [[8], [-1], [2, 5, 2]], ids=str)
def test_sources_that_are_none_are_refused(sources: list[int]) -> None:
    graph = laplacian.adjacency(np.array([[0, 1, 2], [2, 1, 3], [4, 5, 6]]), 8)
    with pytest.raises(ValueError, match="contradict"):
        distance.nearest(*graph, np.array(sources))
