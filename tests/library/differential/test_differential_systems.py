"""Systems of the research module: weights, hard anchors, Poisson, fits, against dense algebra."""

from __future__ import annotations

import math

import meshes
import numpy as np
import pytest
from graphs import components_of

import deltamesh
from deltamesh.differential import (
    LeastSquares,
    Poisson,
    basis_functions,
    deltas,
    fitted_positions,
    laplacian,
)

MESHES = ("icosphere", "two", "hub")


def mesh(name: str):
    if name == "icosphere":
        return meshes.icosphere(2)
    if name == "two":
        return meshes.two_components()
    n = 150  # a row of L too long for the normal equations
    angle = np.arange(n) / n * 2 * np.pi
    rim = np.stack((np.cos(angle), np.sin(angle), 0.1 * np.sin(5 * angle)), axis=1)
    faces = [(n, i, (i + 1) % n) for i in range(n)]
    return np.concatenate((rim, [[0.0, 0, 0.5]])), np.array(faces)


def anchors_of(F, n: int):
    labels = components_of(F, n)
    return np.union1d(np.unique(labels, return_index=True)[1], np.arange(0, n, 13))


def dense(L, anchors, weights, delta, positions):
    """Solution with the columns of hard anchors eliminated, by dense least squares."""
    hard = np.isinf(weights)
    free = np.setdiff1d(np.arange(L.shape[0]), anchors[hard])
    x = np.zeros(delta.shape)
    x[anchors[hard]] = positions[hard]
    S = np.zeros((int((~hard).sum()), L.shape[0]))
    S[np.arange(len(S)), anchors[~hard]] = weights[~hard]
    A = np.vstack((L.toarray(), S))
    b = np.vstack((delta, weights[~hard, None] * positions[~hard])) - A @ x
    x[free] = np.linalg.lstsq(A[:, free], b, rcond=None)[0]
    return x


@pytest.mark.parametrize("solver", ["auto", "core", "scipy"])
@pytest.mark.parametrize("kind", ["soft", "weighed", "hard", "mixed"])
@pytest.mark.parametrize("name", MESHES)
def test_equals_dense_least_squares(name: str, kind: str, solver: str) -> None:
    V, F = mesh(name)
    L, anchors = laplacian(F, len(V)), anchors_of(F, len(V))
    k = len(anchors)
    weights = {
        "soft": np.full(k, 1.0),
        "weighed": np.linspace(0.1, 30, k),
        "hard": np.full(k, math.inf),
        "mixed": np.where(np.arange(k) % 2, math.inf, 3.0),
    }[kind]
    delta = np.round(L @ V, 1)
    moved = V[anchors] + np.random.default_rng(4).normal(size=(k, 3)) / 9
    system = LeastSquares(L, anchors, weights, solver=solver)
    x = system.solve(delta, moved)
    np.testing.assert_allclose(x, dense(L, anchors, weights, delta, moved), atol=1e-9)
    hard = np.isinf(weights)
    np.testing.assert_allclose(x[anchors[hard]], moved[hard], atol=1e-14)
    assert not np.shares_memory(x, delta)


def test_one_weight_is_that_of_all() -> None:
    V, F = meshes.icosphere(1)
    L, a = laplacian(F, len(V)), np.array([1, 20, 30])
    zero = np.zeros_like(V)
    one, each = (LeastSquares(L, a, w).solve(zero, V[a]) for w in (5.0, [5.0] * 3))
    np.testing.assert_array_equal(one, each)
    assert np.abs(one - LeastSquares(L, a).solve(zero, V[a])).max() > 0.01


def test_many_right_hand_sides_are_solved_as_one_by_one() -> None:
    V, F = meshes.icosphere(2)
    L, a = laplacian(F, len(V)), np.array([0, 50, 77])
    rows = np.random.default_rng(1).normal(size=(len(V), 7))
    for system in (LeastSquares(L, a), Poisson(L, a)):
        together = system.solve(rows, rows[a])
        apart = [system.solve(rows[:, i : i + 1], rows[a, i : i + 1]) for i in range(7)]
        np.testing.assert_allclose(together, np.hstack(apart), atol=1e-7)


@pytest.mark.parametrize("name", MESHES)
def test_poisson_keeps_its_rows_and_its_fixed_vertices(name: str) -> None:
    V, F = mesh(name)
    L, fixed = laplacian(F, len(V)), anchors_of(F, len(V))
    free = np.setdiff1d(np.arange(len(V)), fixed)
    b, held = np.random.default_rng(2).normal(size=V.shape), V[fixed] + 1e3
    x = Poisson(L, fixed).solve(b, held, 1e-10)
    D = L.toarray()
    expected = np.linalg.solve(D[np.ix_(free, free)], b[free] - D[np.ix_(free, fixed)] @ held)
    np.testing.assert_allclose(x[fixed], held, rtol=1e-15)
    np.testing.assert_allclose(x[free], expected, atol=1e-10 * np.ptp(held, axis=0).max())


def test_poisson_of_true_deltas_is_the_mesh() -> None:
    V, F = meshes.torus(30, 20)
    L = laplacian(F, len(V))
    x = Poisson(L, [7]).solve(deltas(L, V), V[[7]])  # no extent: the unit is 1
    np.testing.assert_allclose(x, V, atol=1e-9)


@pytest.mark.parametrize("weight", [1.0, 4.0])
def test_fitted_positions_are_the_best(weight: float) -> None:
    V, F = meshes.icosphere(2)
    L, a = laplacian(F, len(V)), np.array([0, 17, 60, 99, 120])
    delta = np.round(deltas(L, V), 1)
    system = LeastSquares(L, a, weight)
    B = basis_functions(system)
    best = np.linalg.lstsq(B, V - system.solve(delta, np.zeros((5, 3))), rcond=None)[0]
    np.testing.assert_allclose(fitted_positions(system, delta, V, 1e-12), best, atol=1e-8)


def test_basis_functions_are_those_of_the_paper() -> None:
    V, F = meshes.two_components()
    L, a = laplacian(F, len(V)), anchors_of(F, len(V))
    system = LeastSquares(L, a)
    B = basis_functions(system)
    np.testing.assert_allclose(B.sum(axis=1), 1, atol=1e-12)
    np.testing.assert_allclose(B @ V[a], system.solve(np.zeros_like(V), V[a]), atol=1e-12)
    np.testing.assert_allclose(basis_functions(system, [2, 0]), B[:, [2, 0]], atol=1e-13)
    A = np.vstack((L.toarray(), np.eye(len(V))[a]))
    np.testing.assert_allclose(B, np.linalg.pinv(A)[:, len(V) :], atol=1e-10)


def test_faults_are_named() -> None:
    V, F = meshes.two_components()
    n, L = len(V), laplacian(F, len(V))
    system = LeastSquares(L, [0, n - 1])
    with pytest.raises(deltamesh.SolveError, match="has no anchor"):
        LeastSquares(L, [0])
    with pytest.raises(deltamesh.SolveError, match="has no anchor"):
        Poisson(L, [0])
    with pytest.raises(ValueError, match="fixed vertices have a vertex twice"):
        Poisson(L, [0, n - 1, 0])
    with pytest.raises(ValueError, match=f"vertices from 0 to {n - 1}"):
        LeastSquares(L, [0, n])
    for weights in (0.0, -1.0, math.nan, [1.0] * 3):
        with pytest.raises(ValueError, match="weights are no positive number"):
            LeastSquares(L, [0, n - 1], weights)
    with pytest.raises(ValueError, match=r"deltas have shape \(3, 3\)"):
        system.solve(np.zeros((3, 3)), V[[0, n - 1]])
    with pytest.raises(ValueError, match=r"positions have shape \(2, 2\), not \(2, 3\)"):
        system.solve(np.zeros_like(V), np.zeros((2, 2)))
    with pytest.raises(ValueError, match="not finite"):
        system.solve(V + math.nan, V[[0, n - 1]])
    with pytest.raises(ValueError, match="an anchor is hard"):
        fitted_positions(LeastSquares(L, [0, n - 1], math.inf), np.zeros_like(V), V)
    with pytest.raises(deltamesh.SolveError, match="no solution in double precision"):
        Poisson(L, [0, n - 1]).solve(1e300 * V, 1e-9 * V[[0, n - 1]])
    with pytest.raises(deltamesh.LimitError):
        LeastSquares(L, [0, n - 1], 2.0, memory=1000)
