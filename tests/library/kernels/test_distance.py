"""Distances along edges, and the linear algebra of greedy anchors."""

from __future__ import annotations

import numpy as np

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
