"""Normal equations and their factorization, against dense matrices."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest
import scipy.sparse as sparse
from scipy.sparse.linalg import splu
from sparse_matrices import GRAPHS, pattern, squared

from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels.mesh import elimination, factor, laplacian
from deltamesh_formats.array_types import Floats

MESHES = meshes.every()
MOST = 1 << 60
RNG = np.random.default_rng(1847)


def planned(matrix: sparse.csr_array, order=None) -> factor.Plan:
    places = pattern(matrix)
    order = elimination.minimum_degree(*places) if order is None else order
    plan = factor.plan(*places, order, MOST)
    assert plan is not None
    return plan


def solved(matrix: sparse.csr_array, b: Floats, order=None) -> Floats:
    return factor.Factor(planned(matrix, order), *pattern(matrix), matrix.data).solve(b)


@pytest.mark.parametrize("name", MESHES)
def test_products_with_the_laplacian(name: str) -> None:
    V, F = MESHES[name]
    L = oracle.laplacian(F, len(V))
    for x in (V, RNG.normal(size=(len(V), 1)), RNG.normal(size=(len(V), 7))):
        np.testing.assert_allclose(laplacian.apply(*adjacency(F, len(V)), x), L @ x, atol=1e-12)


def test_sums_are_in_the_order_of_the_indices() -> None:
    V, F = meshes.icosphere(3)
    indptr, indices = adjacency(F, len(V))
    product = laplacian.apply(indptr, indices, V)
    for i in range(len(V)):
        row = indices[indptr[i] : indptr[i + 1]].tolist()
        sums = np.zeros(3)
        for j in sorted([*row, i]):
            sums += (len(row) if j == i else -1.0) * V[j]
        assert sums.tobytes() == product[i].tobytes()


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("rounds", [0, 1, 7])
def test_smoothing_keeps_the_sum_of_each_component(name: str, rounds: int) -> None:
    V, F = MESHES[name]
    L, graph = oracle.laplacian(F, len(V)), adjacency(F, len(V))
    for x in (V, RNG.normal(size=(len(V), 1)), RNG.normal(size=(len(V), 4))):
        before = x.copy()
        found = laplacian.smooth(*graph, x, rounds)
        np.testing.assert_array_equal(x, before)
        np.testing.assert_allclose(found, poisson_oracle.smoothed(L, x, rounds), atol=1e-12)
        for part in poisson_oracle.parts(L):
            np.testing.assert_allclose(found[part].sum(axis=0), x[part].sum(axis=0), atol=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_the_normal_equations_are_exact(name: str) -> None:
    V, F = MESHES[name]
    n, graph = len(V), adjacency(F, len(V))
    anchors = np.arange(0, n, 7)
    indptr, indices, values = laplacian.normal_matrix(
        *graph, anchors, laplacian.normal_bounds(*graph)
    )
    L = oracle.laplacian(F, n)
    expected = L.T @ L
    expected[anchors, anchors] += 1
    matrix = sparse.csr_array((values, indices, indptr), shape=(n, n))
    np.testing.assert_array_equal(matrix.toarray(), expected)
    for i in range(n):
        row = indices[indptr[i] : indptr[i + 1]]
        assert len(np.unique(row)) == len(row)


def test_bounds_of_another_graph_are_refused() -> None:
    V, F = meshes.icosphere(1)
    graph = adjacency(F, len(V))
    bounds = laplacian.normal_bounds(*graph)
    short = np.minimum(bounds, bounds[-1] - 1)
    with pytest.raises(ValueError, match="contradict"):
        laplacian.normal_matrix(*graph, np.array([0]), short)
    with pytest.raises(ValueError, match="contradict"):
        laplacian.normal_matrix(*graph, np.array([len(V)]), bounds)


@pytest.mark.parametrize("name", GRAPHS)
def test_minimum_degree_is_an_order(name: str) -> None:
    order = elimination.minimum_degree(*pattern(GRAPHS[name]))
    np.testing.assert_array_equal(np.sort(order), np.arange(GRAPHS[name].shape[0]))


@pytest.mark.parametrize("name", ["path", "star", "cliques", "isolated", "tree", "complete"])
def test_minimum_degree_fills_nothing_where_it_need_not(name: str) -> None:
    matrix = GRAPHS[name]
    order = elimination.minimum_degree(*pattern(matrix))
    entries = elimination.factor_entries(*pattern(matrix), order, MOST)
    assert entries == (matrix.nnz + matrix.shape[0]) // 2


@pytest.mark.parametrize(
    "mesh", [meshes.icosphere(5), meshes.torus(120, 90)], ids=["sphere", "torus"]
)
def test_minimum_degree_fills_little_more_than_that_of_another(mesh) -> None:
    matrix = squared(*mesh)
    order = elimination.minimum_degree(*pattern(matrix))
    entries = elimination.factor_entries(*pattern(matrix), order, MOST)
    options = {"SymmetricMode": True}
    other = splu(matrix.tocsc(), "MMD_AT_PLUS_A", diag_pivot_thresh=0, options=options)
    assert entries < 1.3 * other.L.nnz


def test_unknowns_with_very_many_neighbours_come_last() -> None:
    n = 3000
    hub = sparse.csr_array((np.ones(n), (np.zeros(n, dtype=int), np.arange(n))), shape=(n, n))
    matrix = (squared(*meshes.torus(60, 50)) + hub + hub.T).tocsr()
    assert elimination.minimum_degree(*pattern(matrix))[-1] == 0


@pytest.mark.parametrize("name", GRAPHS)
def test_solutions_are_those_of_dense_matrices(name: str) -> None:
    matrix = GRAPHS[name]
    n = matrix.shape[0]
    for order in (None, np.arange(n), RNG.permutation(n)):
        for columns in (1, 3, 4, 16, 21):
            b = RNG.normal(size=(n, columns))
            expected = oracle.solve_by_elimination(matrix.toarray(), b)
            np.testing.assert_allclose(solved(matrix, b, order), expected, atol=1e-9)


@pytest.mark.parametrize("name", GRAPHS)
def test_the_entries_of_a_plan(name: str) -> None:
    """No fewer than those of the factor, of which there are as many in the plan's own order."""
    matrix = GRAPHS[name]
    order = RNG.permutation(matrix.shape[0])
    plan = planned(matrix, order)
    np.testing.assert_array_equal(np.sort(plan.order), np.sort(order))
    entries = oracle.factor_entries(matrix, order)
    assert oracle.factor_entries(matrix, plan.order) == entries
    assert plan.entries >= entries
    assert factor.plan(*pattern(matrix), order, entries) is not None
    if entries:
        assert factor.plan(*pattern(matrix), order, entries - 1) is None


def test_quasidefinite_matrices() -> None:
    """Positive ones above, negative ones below: an L D L^T in every order (Vanderbei)."""
    A = squared(*meshes.icosphere(2))
    n, k = A.shape[0], 30
    B = sparse.csr_array(RNG.normal(size=(k, n)) * (RNG.random((k, n)) < 0.3))
    matrix = sparse.block_array([[A, B.T], [B, -sparse.eye_array(k)]], format="csr")
    b = RNG.normal(size=(n + k, 3))
    for order in (None, RNG.permutation(n + k)):
        expected = oracle.solve_by_elimination(matrix.toarray(), b)
        np.testing.assert_allclose(solved(matrix, b, order), expected, atol=1e-9)


def test_the_same_bits_again() -> None:
    matrix = squared(*meshes.icosphere(4))
    b = RNG.normal(size=(matrix.shape[0], 3))
    assert solved(matrix, b).tobytes() == solved(matrix, b).tobytes()


@pytest.mark.parametrize("value", [0.0, np.nan, np.inf])
def test_a_pivot_that_is_none_is_refused(value: float) -> None:
    matrix = sparse.csr_array(np.diag([1.0, 2.0, 3.0]))
    matrix.data[1] = value
    with pytest.raises(ArithmeticError, match="pivot of unknown 1 "):
        solved(matrix, np.ones((3, 1)))


def test_a_matrix_that_was_not_planned_is_refused() -> None:
    plan = planned(GRAPHS["path"])
    other = GRAPHS["random"]
    with pytest.raises(ValueError, match="contradict"):
        factor.Factor(plan, *pattern(other), other.data)
    more = sparse.csr_array(GRAPHS["path"] + GRAPHS["star"][:300, :300])
    with pytest.raises(ValueError, match="contradict"):
        factor.Factor(plan, *pattern(more), more.data)
