"""Directions of conjugate gradients: they solve small systems, and are conjugate."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from deltamesh._geometry.directions import directions, quotient

K = 12


def definite(seed: int) -> np.ndarray:
    B = np.random.default_rng(seed).normal(size=(K, K))
    return B @ B.T + np.eye(K)


PRECONDITIONS = {
    "none": np.copy,
    "diagonal": lambda r: r / np.diag(definite(1))[:, None],
    "inverse": lambda r: np.linalg.solve(definite(1), r),
}


@pytest.mark.parametrize("name", PRECONDITIONS)
def test_they_are_conjugate_and_solve_the_system(name: str) -> None:
    A, b = definite(1), np.random.default_rng(2).normal(size=(K, 3))
    b[:, 2] = 0
    x, r, taken = np.zeros_like(b), b.copy(), []
    for p, product in islice(directions(r, PRECONDITIONS[name]), 1 if name == "inverse" else K):
        a = quotient(product, (p * (A @ p)).sum(axis=0))
        x += a * p
        r -= a * (A @ p)
        taken.append(p)
    np.testing.assert_allclose(x, np.linalg.solve(A, b), atol=1e-9)
    for i, p in enumerate(taken[:4]):
        for q in taken[:i]:
            assert (p * (A @ q)).sum(axis=0) == pytest.approx(0, abs=1e-9)


def test_a_direction_is_none_of_the_residual() -> None:
    """Steps change the residual in place; directions before them must stay."""
    r = np.ones((K, 1))
    p, _ = next(directions(r, np.copy))
    r -= 1
    assert (p == 1).all()


def test_a_quotient_of_nothing_is_nothing() -> None:
    np.testing.assert_array_equal(quotient(np.array([0.0, 6.0]), np.array([0.0, 3.0])), [0, 2])
