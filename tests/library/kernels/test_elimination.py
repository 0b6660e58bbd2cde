"""Elimination: entries counted as the elimination game makes them, and orders of little fill."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import scipy.sparse as sparse
from scipy.sparse.linalg import splu
from sparse_matrices import GRAPHS, graph, pattern, squared

from deltamesh._kernels.mesh import elimination

RNG = np.random.default_rng(4711)
MOST = 1 << 60


@pytest.mark.parametrize("name", GRAPHS)
def test_the_entries_of_a_factor_are_counted_exactly(name: str) -> None:
    matrix = GRAPHS[name]
    n = matrix.shape[0]
    for order in (np.arange(n), RNG.permutation(n), elimination.dissect(*pattern(matrix))):
        expected = oracle.factor_entries(matrix, order)
        assert elimination.factor_entries(*pattern(matrix), order, MOST) == expected
        assert elimination.factor_entries(*pattern(matrix), order, expected) == expected
        if expected > n:
            assert elimination.factor_entries(*pattern(matrix), order, expected - 1) > expected - 1


@pytest.mark.parametrize("name", GRAPHS)
def test_a_dissection_is_an_order(name: str) -> None:
    order = elimination.dissect(*pattern(GRAPHS[name]))
    np.testing.assert_array_equal(np.sort(order), np.arange(GRAPHS[name].shape[0]))


@pytest.mark.parametrize("name", ["path", "star", "cliques", "isolated"])
def test_no_fill_or_little_where_none_is_needed(name: str) -> None:
    matrix = GRAPHS[name]
    order = elimination.dissect(*pattern(matrix))
    entries = elimination.factor_entries(*pattern(matrix), order, MOST)
    assert entries <= 1.5 * (matrix.nnz + matrix.shape[0]) / 2


@pytest.mark.parametrize("mesh", [meshes.icosphere(5), meshes.torus(120, 90)], ids=str)
def test_surfaces_fill_little_more_than_by_minimum_degree(mesh) -> None:
    matrix = squared(*mesh)
    order = elimination.dissect(*pattern(matrix))
    entries = elimination.factor_entries(*pattern(matrix), order, MOST)
    options = {"SymmetricMode": True}
    other = splu(matrix.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0, options=options)
    assert entries < 1.6 * other.L.nnz


def test_a_component_with_a_hub_is_dissected_without_it() -> None:
    V, F = meshes.torus(60, 60)
    n = len(V)
    hub = np.stack((np.full(n, n), np.arange(n)), axis=1)
    torus = squared(V, F)
    wheel = sparse.block_diag([torus, sparse.eye_array(1)], format="csr")
    matrix = (wheel + 1e-3 * (graph(n + 1, hub) != 0)).tocsr()
    order = elimination.dissect(*pattern(matrix))
    assert order[-1] == n
    without = elimination.factor_entries(
        *pattern(torus), elimination.dissect(*pattern(torus)), MOST
    )
    assert elimination.factor_entries(*pattern(matrix), order, MOST) == without + n + 1


@pytest.mark.parametrize("name", GRAPHS)
def test_the_entries_of_a_product_are_counted_exactly(name: str) -> None:
    A = sparse.vstack([GRAPHS[name], GRAPHS[name][:7]], format="csr")
    A.data[:] = 1
    columns = A.T.tocsr()
    expected = (columns @ A).nnz
    places = (*pattern(A), *pattern(columns))
    assert elimination.product_entries(*places, MOST) == expected
    assert elimination.product_entries(*places, expected) == expected
    if expected:
        assert elimination.product_entries(*places, expected - 1) > expected - 1


def test_breadth() -> None:
    assert elimination.breadth(*pattern(GRAPHS["nothing"])) == 0
    assert elimination.breadth(*pattern(GRAPHS["isolated"])) == 1
    assert elimination.breadth(*pattern(GRAPHS["path"])) == 1
    assert elimination.breadth(*pattern(GRAPHS["complete"])) == 25
    assert elimination.breadth(*pattern(GRAPHS["cliques"])) == 15
    assert elimination.breadth(*pattern(GRAPHS["star"])) == 200
