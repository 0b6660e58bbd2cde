"""Interpolated anchors: positions against dense solutions of the whole rectangular system."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import poisson_oracle
import pytest
import strategies
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._geometry.cells import Cells
from deltamesh._geometry.interpolation import TOLERANCE, Interpolation
from deltamesh._graph.adjacency import adjacency, components
from deltamesh_formats.errors import SolveError

MESHES = meshes.every()


def system_of(F, n: int, anchors) -> Interpolation:
    graph = adjacency(F, n)
    return Interpolation(Cells(graph, components(*graph), anchors))


def surface(mesh, seed: int, share: float):
    """Faces over used vertices, and anchors: one a component, and a share of the others."""
    used, F = np.unique(mesh[1], return_inverse=True)
    F, n, rng = F.reshape(-1, 3), len(used), np.random.default_rng(seed)
    first = np.unique(components(*adjacency(F, n)), return_index=True)[1]
    more = rng.permutation(n)[: round(share * n)]
    return F, n, rng.permutation(np.union1d(first, more)), rng


@strategies.SOME
@given(strategies.surfaces(), st.integers(0, 2**32), st.floats(0, 1), st.booleans())
def test_positions_are_those_of_dense_matrices(mesh, seed, share, alike) -> None:
    F, n, anchors, rng = surface(mesh, seed, share)
    system, L = system_of(F, n, anchors), oracle.laplacian(F, n)
    p, y = rng.normal(size=(len(anchors), 3)) * 10, rng.normal(size=(len(anchors), 3))
    steps = np.full((n, 1), 0.01) if alike else 0.01 * 2.0 ** -rng.integers(0, 9, (n, 1))
    delta = system.cells.completed(rng.normal(size=(n, 3)), y)
    expected = poisson_oracle.solution(L, anchors.tolist(), delta, p)
    for start in (None, expected + 0.1 * rng.normal(size=(n, 3))):
        x = system.solve(delta.copy(), p, steps, start=start)
        for part in poisson_oracle.parts(L):
            error = np.abs(x - expected)[part].max()
            assert error <= TOLERANCE * steps[part].min() * (1 + 1e-6)
        np.testing.assert_allclose(x[anchors], p, rtol=1e-14, atol=1e-12)


@strategies.SOME
@given(strategies.surfaces(), st.integers(0, 2**32), st.floats(0, 1))
def test_with_what_anchors_lack_they_are_those_of_least_squares(mesh, seed, share) -> None:
    """Once the rows of the anchors hold as well, the whole system has a solution: this one."""
    F, n, anchors, rng = surface(mesh, seed, share)
    system, L = system_of(F, n, anchors), oracle.laplacian(F, n)
    p, delta = rng.normal(size=(len(anchors), 3)), rng.normal(size=(n, 3))
    x = system.solve(delta, p, np.ones((n, 1)), 1e-11)
    delta[anchors] = (L @ x)[anchors]
    expected = oracle.least_squares(L, anchors, delta, p)
    np.testing.assert_allclose(x, expected, atol=1e-9)
    residual = L @ x - delta
    np.testing.assert_allclose(residual, 0, atol=1e-9)


def test_far_from_the_origin_only_the_sum_is_rounded() -> None:
    V, F = meshes.torus(40, 30)
    system, delta = system_of(F, len(V), np.array([7, 600])), oracle.laplacian(F, len(V)) @ V
    steps = np.full((len(V), 1), 1e-7)
    x = system.solve(delta, V[[7, 600]] + 4e6, steps, 1e-4)
    np.testing.assert_allclose(x, V + 4e6, rtol=0, atol=2 * np.spacing(4e6))


def test_a_component_of_a_millionth_keeps_its_digits() -> None:
    V, F = meshes.icosphere(3)
    n, small = len(V), 1e-6 * V
    F, L = meshes.union((V, F), (V, F))[1], oracle.laplacian(F, n)
    delta = np.concatenate([L @ V, L @ small])
    p = np.stack([V[0], small[0] + [1.0, 2.0, 3.0]])
    steps = np.repeat([[0.01], [1e-8]], n, axis=0)
    x = system_of(F, 2 * n, np.array([0, n])).solve(delta, p, steps)
    np.testing.assert_allclose(x[:n], V, rtol=0, atol=1e-5)
    np.testing.assert_allclose(x[n:], small - small[0] + p[1], rtol=0, atol=1e-11)


@pytest.mark.parametrize("scale", [1e-150, 2.0**-40, 1e140])
def test_scale_changes_nothing(scale: float) -> None:
    V, F = MESHES["double_torus"]
    n, anchors = len(V), np.array([3, 40])
    system, delta = system_of(F, n, anchors), oracle.laplacian(F, n) @ V
    one = system.solve(delta.copy(), V[anchors], np.full((n, 1), 0.01))
    other = system.solve(delta * scale, V[anchors] * scale, np.full((n, 1), 0.01 * scale))
    np.testing.assert_allclose(other / scale, one, atol=1e-9)


def test_steps_below_what_doubles_tell_apart() -> None:
    """A billionth of the extent is what a coordinate may err by then, and no iteration is lost."""
    V, F = meshes.torus(30, 20)
    n, anchors = len(V), np.array([3])
    delta = oracle.laplacian(F, n) @ V
    for step in (1e-9, 1e-12, 1e-15):
        x = system_of(F, n, anchors).solve(delta.copy(), V[anchors], np.full((n, 1), step))
        np.testing.assert_allclose(x, V, rtol=0, atol=1e-9 * 8)


@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, 1e308])
def test_what_overflows_is_refused(wrong: float) -> None:
    V, F = MESHES["torus"]
    n, anchors = len(V), np.array([3, 4])
    system, steps = system_of(F, n, anchors), np.full((n, 1), 0.01)
    delta, p = np.zeros((n, 3)), np.zeros((2, 3))
    for array in (delta, p):
        array[1, 2] = wrong
        with pytest.raises(SolveError, match="no solution in double precision"):
            system.solve(delta.copy(), p, steps)
        array[1, 2] = 0


def test_a_hopeless_system_is_refused() -> None:
    n = 100_000
    i = np.arange(n - 2)
    F = np.stack((i, i + 1 + i % 2, i + 2 - i % 2), axis=1)
    delta = np.random.default_rng(64).normal(size=(n, 3))
    with pytest.raises(SolveError, match="no solution in double precision"):
        system_of(F, n, np.array([0])).solve(delta, np.zeros((1, 3)), np.full((n, 1), 1e-12))


def test_nothing_is_solved_of_nothing() -> None:
    nothing = np.zeros(0, dtype=np.int64)
    cells = Cells(adjacency(np.zeros((0, 3), dtype=np.int64), 0), nothing, nothing)
    x = Interpolation(cells).solve(np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 1)))
    assert x.shape == (0, 3)
