"""Solvers of least squares, against a dense one."""

from __future__ import annotations

import importlib.util
import itertools

import meshes
import numpy as np
import oracle
import pytest
from graphs import components_of, graph_of, laplacian_of, least_squares

from deltamesh._geometry import normal_equations, solve, solvers
from deltamesh._graph.adjacency import adjacency
from deltamesh_formats.errors import SolveError

MESHES = meshes.every()
SOLVERS = [
    pytest.param(name, marks=pytest.mark.skipif(not found, reason=f"{module} is not installed"))
    for name, module in (
        ("core", "deltamesh"),
        ("rslab", "rslab"),
        ("pardiso", "pypardiso"),
        ("scipy", "scipy"),
    )
    for found in [importlib.util.find_spec(module)]
]


def anchors_of(F, n, spacing=20):
    """The lowest vertex of each component, and some more."""
    labels = components_of(F, n)
    return np.union1d(np.unique(labels, return_index=True)[1], np.arange(0, n, spacing))


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("name", MESHES)
def test_equals_dense_least_squares(name: str, solver: str) -> None:
    V, F = MESHES[name]
    L, anchors = laplacian_of(F, len(V)), anchors_of(F, len(V))
    delta = np.round(L @ V, 1)  # not the Laplacian of anything: residuals are large
    x = least_squares(L, anchors, delta, V[anchors], solver)
    expected = oracle.least_squares(L.toarray(), anchors, delta, V[anchors])
    np.testing.assert_allclose(x, expected, atol=1e-12)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("columns", [1, 2, 7])
def test_any_number_of_columns(columns: int, solver: str) -> None:
    V, F = meshes.icosphere(1)
    L, anchors = laplacian_of(F, len(V)), np.array([3, 40])
    x = np.random.default_rng(823).normal(size=(len(V), columns))
    system = solve.LeastSquares(graph_of(L), anchors, solver)
    np.testing.assert_allclose(system.solve(L @ x, x[anchors]), x, atol=1e-12)
    normal = L.T @ L
    normal[anchors, anchors] += 1
    np.testing.assert_allclose(normal @ system.solve_normal(x), x, atol=1e-10)


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize("n", [1, 2, 3])
def test_isolated_vertices_stay_at_their_anchors(n: int, solver: str) -> None:
    L = laplacian_of(np.empty((0, 3), dtype=np.int64), n)
    positions = np.random.default_rng(5).normal(size=(n, 3))[::-1]
    x = least_squares(L, np.arange(n)[::-1], np.zeros((n, 3)), positions, solver)
    np.testing.assert_allclose(x, positions[::-1], atol=1e-15)


@pytest.mark.parametrize("solver", SOLVERS)
def test_far_from_the_origin_only_the_sum_is_rounded(solver: str) -> None:
    V, F = meshes.torus(40, 30)
    L, anchors = laplacian_of(F, len(V)), np.array([7])
    x = least_squares(L, anchors, L @ V, V[anchors] + 4e6, solver)
    np.testing.assert_allclose(x, V + 4e6, rtol=0, atol=np.spacing(4e6))


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_component_of_a_millionth_keeps_its_digits(solver: str) -> None:
    """Two spheres, the sizes and the distance of which are a million times as large as one."""
    V, F = meshes.icosphere(4)
    n, small = len(V), 1e-6 * V
    L = laplacian_of(meshes.union((V, F), (V, F))[1], 2 * n)
    one = L[:n, :n]
    delta, anchors = np.concatenate([one @ V, one @ small]), np.array([0, n])
    positions = np.stack([V[0], small[0] + [1.0, 2.0, 3.0]])
    x = least_squares(L, anchors, delta, positions, solver)
    np.testing.assert_allclose(x[:n], V, rtol=0, atol=1e-13)
    expected = small - small[0] + positions[1]
    assert (np.abs(x[n:] - expected) <= np.spacing(3.0)).all()


@pytest.mark.parametrize("solver", SOLVERS)
def test_each_component_is_refined(solver: str) -> None:
    """A small strip that the normal equations alone get wrong, beside a large triangle."""
    i = np.arange(2998)
    strip = np.stack((i, i + 1 + i % 2, i + 2 - i % 2), axis=1)
    F = np.concatenate([strip, [[3000, 3001, 3002]]])
    x = 1e-6 * np.sin(np.arange(3003.0) / 500)[:, None]
    x[3000:, 0] = [0.0, 1.0, 2.0]
    L, anchors = laplacian_of(F, 3003), np.array([0, 3000])
    error = np.abs(least_squares(L, anchors, L @ x, x[anchors], solver) - x)
    assert error[:3000].max() < 1e-15


@pytest.mark.parametrize("solver", SOLVERS)
def test_ill_conditioned_is_refined(solver: str) -> None:
    # A strip of 3000 vertices with an anchor at its end: the normal equations alone err by 1e-5.
    i = np.arange(2998)
    F = np.stack((i, i + 1 + i % 2, i + 2 - i % 2), axis=1)
    x = np.sin(np.arange(3000.0) / 500)[:, None]
    L, anchors = laplacian_of(F, 3000), np.array([0])
    assert np.abs(least_squares(L, anchors, L @ x, x[anchors], solver) - x).max() < 1e-9


def cone_pair(n):
    """Two apexes over a ring of n vertices: their rows have n + 1 entries."""
    ring = np.arange(n)
    turned = np.roll(ring, -1)
    top, bottom = np.full(n, n), np.full(n, n + 1)
    return np.concatenate(
        (np.stack((ring, turned, top), axis=1), np.stack((turned, ring, bottom), axis=1))
    )


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    "F",
    [cone_pair(2000), np.array([(0, i, j) for i, j in itertools.combinations(range(1, 130), 2)])],
    ids=["hubs", "complete"],
)
def test_vertices_of_high_valence(F, solver: str) -> None:
    n = F.max() + 1
    x = np.random.default_rng(91).normal(size=(n, 3))
    L, anchors = laplacian_of(F, n), np.array([n - 1])
    np.testing.assert_allclose(least_squares(L, anchors, L @ x, x[anchors], solver), x, atol=1e-10)


def test_long_rows_do_not_fill_the_matrix() -> None:
    n = 20_000
    L = laplacian_of(cone_pair(n), n + 2)
    A = L.tocsr()
    assert normal_equations._quasidefinite(A, A.T.tocsr()).nnz < 30 * n


def test_the_number_of_threads_leaves_every_bit_alone() -> None:
    V, F = meshes.icosphere(5)
    L, anchors = laplacian_of(F, len(V)), np.array([5, 77, 1000])
    one, two = (
        least_squares(L, anchors, np.round(L @ V, 4), V[anchors], "rslab", threads)
        for threads in (1, 2)
    )
    assert one.tobytes() == two.tobytes()


def test_inputs_stay_as_they_are() -> None:
    V, F = meshes.icosphere(1)
    L, anchors = laplacian_of(F, len(V)), np.array([0, 9])
    delta, positions = L @ V, V[anchors]
    copies = L.copy(), anchors.copy(), delta.copy(), positions.copy()
    least_squares(L, anchors, delta, positions)
    np.testing.assert_array_equal(L.toarray(), copies[0].toarray())
    for array, copy in zip((anchors, delta, positions), copies[1:], strict=True):
        np.testing.assert_array_equal(array, copy)


def test_a_component_without_anchor_is_refused() -> None:
    V, F = meshes.two_components()
    with pytest.raises(SolveError, match="component of vertex 42 has no anchor"):
        solve.LeastSquares(adjacency(F, len(V)), np.array([3]))


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_hopeless_system_is_refused(solver: str) -> None:
    i = np.arange(199_998)
    F = np.stack((i, i + 1 + i % 2, i + 2 - i % 2), axis=1)
    L = laplacian_of(F, 200_000)
    delta = np.random.default_rng(64).normal(size=(200_000, 1))
    with pytest.raises(SolveError):
        least_squares(L, np.array([0]), delta, np.zeros((1, 1)), solver)


def test_unknown_and_missing_solvers(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(SolveError, match="unknown solver 'cholmod': choose auto, core, rslab"):
        solvers.solver_name("cholmod")
    monkeypatch.setattr(solvers, "_installed", lambda module: module == "scipy")
    assert solvers.solver_name("auto") == "scipy"
    with pytest.raises(SolveError, match=r'pip install "deltamesh\[mkl\]"'):
        solvers.solver_name("pardiso")
