"""The Poisson problem: against dense solutions, and on graphs that few solvers are made for."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._geometry.poisson import Poisson
from deltamesh._graph.adjacency import adjacency, components
from deltamesh._kernels.mesh import laplacian

MESHES = meshes.every()


def solved(problem: Poisson, b, x, *arguments, **keywords):
    """The solution from where x starts, which stays as it is, and the bound on its error."""
    x = x.copy()
    bound = problem.solve(b, x, *arguments, **keywords)
    return x, bound


def first_of_components(graph):
    return np.unique(components(*graph), return_index=True)[1]


def strip(n):
    i = np.arange(n - 2)
    return np.stack((i, i + 1 + i % 2, i + 2 - i % 2), axis=1)


def fan(n):
    """A hub, the last vertex, and a ring around it."""
    i = np.arange(n - 1)
    return np.stack((i, np.roll(i, -1), np.full(n - 1, n - 1)), axis=1)


def graph_of_edges(n, edges):
    """The neighbour lists of any edges (e, 2) that are different."""
    both = np.concatenate([edges, edges[:, ::-1]])
    both = both[np.lexsort((both[:, 1], both[:, 0]))]
    indptr = np.searchsorted(both[:, 0], np.arange(n + 1))
    return indptr.astype(np.int32), both[:, 1].astype(np.int32)


@strategies.SOME
@given(strategies.surfaces(), st.integers(0, 2**32), st.sampled_from([1e-2, 1e-6, 1e-9]))
def test_solutions_are_those_of_dense_matrices(mesh, seed: int, tolerance: float) -> None:
    """And no coordinate errs by more than the bound."""
    used, F = np.unique(mesh[1], return_inverse=True)
    n, rng = len(used), np.random.default_rng(seed)
    graph = adjacency(F.reshape(-1, 3), n)
    more = rng.permutation(n)[: rng.integers(0, n + 1)]
    fixed = np.union1d(first_of_components(graph), more)
    b, x = rng.normal(size=(n, 3)), rng.normal(size=(n, 3))
    L = oracle.laplacian(F.reshape(-1, 3), n)
    free = np.setdiff1d(np.arange(n), fixed)
    expected = x.copy()
    right = b[free] - L[np.ix_(free, fixed)] @ x[fixed]
    expected[free] = np.linalg.solve(L[np.ix_(free, free)], right)
    problem = Poisson(graph, fixed)
    for start in (x, np.where(np.isin(np.arange(n), fixed)[:, None], x, 0.0)):
        found, bound = solved(problem, b, start, tolerance)
        assert np.abs(found - expected).max() <= bound * (1 + 1e-6) + 1e-13
        assert bound <= tolerance
        np.testing.assert_array_equal(found[fixed], x[fixed])


@pytest.mark.parametrize("seed", range(30))
def test_the_bound_on_graphs_of_any_shape(seed: int) -> None:
    """Random edges, so that degrees and components are of all sizes; few or many fixed."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 200))
    pairs = np.sort(rng.integers(0, n, (int(rng.integers(0, 4 * n)), 2)) ** rng.choice([1, 1, 2]))
    pairs = np.unique(pairs % n, axis=0)
    edges = np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)
    graph = graph_of_edges(n, edges)
    fixed = np.union1d(first_of_components(graph), rng.permutation(n)[: rng.integers(0, 9)])
    expected = rng.normal(size=(n, 3)) * 10.0 ** rng.integers(-5, 6)
    b, x = laplacian.apply(*graph, expected), np.zeros((n, 3))
    x[fixed] = expected[fixed]
    tolerance = 10.0 ** -rng.integers(1, 6) * np.abs(expected).max()
    found, bound = solved(Poisson(graph, fixed), b, x, tolerance)
    assert np.abs(found - expected).max() <= bound * (1 + 1e-6) <= tolerance * (1 + 1e-6)


def clusters():
    """Cliques on a chain of single edges."""
    rows = [np.stack(np.triu_indices(40, 1), axis=1) + 40 * k for k in range(50)]
    links = np.stack((np.arange(39, 1999, 40), np.arange(40, 2000, 40)), axis=1)
    return graph_of_edges(2000, np.concatenate([*rows, links]))


N = 100_000
HUGE = {
    "hub": (adjacency(fan(N), N), [0]),
    "hub that is fixed": (adjacency(fan(N), N), [N - 1]),
    "star": (graph_of_edges(N, np.stack((np.zeros(N - 1, int), np.arange(1, N)), axis=1)), [7]),
    "two hubs": (adjacency(np.concatenate([fan(N), fan(N)[:, ::-1] + N // 2]), N + N // 2), [5]),
    "triangles": (adjacency(np.arange(3 * N).reshape(-1, 3), 3 * N), np.arange(0, 3 * N, 3)),
    "one triangle": (adjacency(np.array([[0, 1, 2]]), 3), [1]),
    "single vertices": (adjacency(np.zeros((0, 3), int), N), np.arange(N)),
    "one vertex": (adjacency(np.zeros((0, 3), int), 1), [0]),
    "clusters": (clusters(), [1000]),
    "many fixed": (adjacency(meshes.torus(300, 300)[1], 90_000), np.arange(0, 90_000, 2)),
    "all fixed": (adjacency(meshes.torus(30, 30)[1], 900), np.arange(900)),
    "strip, fixed often": (adjacency(strip(N), N), np.arange(0, N, 1000)),
    "chain, fixed often": (
        graph_of_edges(N, np.stack((np.arange(N - 1), np.arange(1, N)), axis=1)),
        np.arange(0, N, 500),
    ),
    "torus": (adjacency(meshes.torus(300, 300)[1], 90_000), [4]),
}


@pytest.mark.parametrize("name", HUGE)
def test_graphs_of_all_shapes(name: str) -> None:
    graph, fixed = HUGE[name]
    n, fixed = len(graph[0]) - 1, np.array(fixed)
    expected = np.random.default_rng(5).normal(size=(n, 3))
    b, x = laplacian.apply(*graph, expected), np.zeros((n, 3))
    x[fixed] = expected[fixed]
    found, bound = solved(Poisson(graph, fixed), b, x, 1e-4, 100)
    assert np.abs(found - expected).max() <= bound <= 1e-4


@pytest.mark.parametrize("kind", ["strip", "chain"])
def test_a_bound_that_doubles_cannot_keep_is_not_given(kind: str) -> None:
    """With one end fixed, a residual of a rounding is an error of 10^10 roundings at the other."""
    edges = np.stack((np.arange(N - 1), np.arange(1, N)), axis=1)
    graph = adjacency(strip(N), N) if kind == "strip" else graph_of_edges(N, edges)
    expected = np.random.default_rng(6).normal(size=(N, 3))
    b, x = laplacian.apply(*graph, expected), np.zeros((N, 3))
    x[0] = expected[0]
    for most in (60, 1000):
        found, bound = solved(Poisson(graph, np.array([0])), b, x, 1e-9, most)
        assert np.abs(found - expected).max() <= bound
        assert bound > 1e-9


def test_without_a_tolerance_no_error_is_bounded() -> None:
    V, F = MESHES["torus"]
    graph = adjacency(F, len(V))
    problem, b = Poisson(graph, np.array([0])), laplacian.apply(*graph, V)
    x = np.zeros_like(V)
    x[0] = V[0]
    found, bound = solved(problem, b, x, most=3)
    assert bound == np.inf
    assert np.abs(found - V).max() < np.abs(x - V).max()
    closer, _ = solved(problem, b, x, most=30)
    np.testing.assert_allclose(closer, V, atol=1e-9)
    # Whether a bound was asked for before makes no difference to what iterations find.
    solved(problem, b, x, 1e-6)
    again, bound = solved(problem, b, x, most=3)
    assert again.tobytes() == found.tobytes()
    assert np.abs(found - V).max() <= bound


@pytest.mark.parametrize("columns", [1, 2, 3])
def test_columns_do_not_know_of_each_other(columns: int) -> None:
    V, F = MESHES["double_torus"]
    graph = adjacency(F, len(V))
    b, x = laplacian.apply(*graph, V), np.zeros_like(V)
    x[3] = V[3]
    whole, _ = solved(Poisson(graph, np.array([3])), b, x, most=5)
    b[:, columns:] = x[:, columns:] = 0
    found, _ = solved(Poisson(graph, np.array([3])), b, x, most=5)
    np.testing.assert_array_equal(found[:, :columns], whole[:, :columns])
    assert not found[:, columns:].any()


def test_the_same_again_to_the_last_bit() -> None:
    graph, fixed = HUGE["many fixed"]
    rng = np.random.default_rng(11)
    b, x = rng.normal(size=(90_000, 3)), rng.normal(size=(90_000, 3))
    one, two = (solved(Poisson(graph, fixed), b, x, 1e-5)[0] for _ in range(2))
    assert one.tobytes() == two.tobytes()


def test_all_but_the_free_vertices_stays_as_it_is() -> None:
    graph, fixed = HUGE["clusters"][0], np.array(HUGE["clusters"][1])
    rng = np.random.default_rng(12)
    arrays = *graph, fixed, rng.normal(size=(2000, 3)), rng.normal(size=(2000, 3))
    copies = [array.copy() for array in arrays]
    Poisson(arrays[:2], fixed).solve(*arrays[3:], 1e-5)
    for array, copy in zip(arrays[:4], copies[:4], strict=True):
        np.testing.assert_array_equal(array, copy)
    np.testing.assert_array_equal(arrays[4][fixed], copies[4][fixed])
    assert (np.delete(arrays[4], fixed, axis=0) != np.delete(copies[4], fixed, axis=0)).all()
