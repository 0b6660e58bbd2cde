"""Distance from a point to a triangle, against brute force."""

from __future__ import annotations

import numpy as np
import oracle
import pytest

from deltamesh._kernels.mesh import closest


def test_point_to_triangle_equals_its_oracle() -> None:
    rng = np.random.default_rng(31)
    for _ in range(300):
        triangle, p = rng.normal(size=(3, 3)), 2 * rng.normal(size=3)
        expected = oracle.squared_to_triangle(p, triangle)
        assert closest.squared_to_triangle(p, *triangle) == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    "corners",
    [[[0, 0, 0]] * 3, [[0, 0, 0], [1, 0, 0], [1, 0, 0]], [[0, 0, 0], [1, 0, 0], [3, 0, 0]]],
)
def test_point_to_triangle_without_area(corners: list[list[float]]) -> None:
    triangle = np.array(corners, dtype=float)
    for p in np.random.default_rng(33).normal(size=(50, 3)):
        expected = oracle.squared_to_triangle(p, triangle)
        assert closest.squared_to_triangle(p, *triangle) == pytest.approx(expected, rel=1e-12)
