"""Vectors in rows, against numpy and by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._vectors import angles, crosses, dots, largest, lengths, safe_lengths, sides


@given(st.integers(0, 10**6), st.integers(0, 20))
def test_products_are_those_of_numpy(seed: int, count: int) -> None:
    a, b = np.random.default_rng(seed).normal(size=(2, count, 3))
    np.testing.assert_allclose(crosses(a, b), np.cross(a, b).reshape(count, 3))
    np.testing.assert_allclose(dots(a, b), (a * b).sum(axis=1), atol=1e-14)
    np.testing.assert_allclose(lengths(a), np.linalg.norm(a, axis=1))


@pytest.mark.parametrize("degrees", [0.0, 1e-9, 30.0, 90.0, 179.0, 180.0])
@pytest.mark.parametrize("length", [1e-100, 1.0, 1e100])
def test_angles_by_hand(degrees: float, length: float) -> None:
    turn = np.radians(degrees)
    a, b = np.array([[1.0, 0, 0]]), length * np.array([[np.cos(turn), np.sin(turn), 0]])
    assert angles(a, b)[0] == pytest.approx(degrees, rel=1e-12)


def test_zero_vectors_have_no_angle() -> None:
    assert angles(np.zeros((1, 3)), np.eye(3)[:1])[0] == 0


def test_safe_lengths_at_any_scale() -> None:
    rows = np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.0], [1.0, -2.0, 2.0]])
    for power in (-1060, -700, -300, 0, 300, 700, 1010):
        wanted = np.ldexp([5.0, 0.0, 3.0], power)
        np.testing.assert_array_equal(safe_lengths(np.ldexp(rows, power)), wanted)
    assert len(safe_lengths(np.zeros((0, 3)))) == 0


@given(st.integers(0, 10**6), st.integers(1, 20), st.integers(1, 4))
def test_sides_of_a_box_are_those_of_numpy(seed: int, count: int, columns: int) -> None:
    V = np.random.default_rng(seed).normal(size=(count, columns))
    np.testing.assert_array_equal(sides(V), np.ptp(V, axis=0))
    np.testing.assert_array_equal(sides(V[:0]), np.zeros(columns))


@pytest.mark.parametrize(
    ("numbers", "wanted"),
    [([], 0), ([1.5, -2.5], 2.5), ([3, -2], 3), ([-(2**63), 1], 2.0**63), ([-np.inf], np.inf)],
)
def test_largest_magnitude(numbers: list[float], wanted: float) -> None:
    assert largest(np.array(numbers)) == wanted
    assert np.isnan(largest(np.array([*numbers, np.nan])))
