"""Vertices at one position."""

import numpy as np

from deltamesh_formats.meshfiles.welding import welded


def test_positions_are_in_the_order_of_their_first_appearance() -> None:
    points = np.array([[2, 0, 0], [1, 0, 0], [2, -0.0, 0], [0, 0, 0], [1, 0, 0]], dtype=float)
    found, index = welded(points)
    assert found.tolist() == [[2, 0, 0], [1, 0, 0], [0, 0, 0]]
    assert index.tolist() == [0, 1, 0, 2, 1]


def test_nothing_is_welded_of_nothing() -> None:
    found, index = welded(np.empty((0, 3)))
    assert (found.shape, index.shape) == ((0, 3), (0,))
