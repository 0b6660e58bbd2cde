"""Permutations, and values numbered by their first appearance."""

from __future__ import annotations

import numpy as np

from deltamesh._graph.permutations import numbered


def test_values_are_numbered_by_their_first_elements() -> None:
    found, order = numbered(np.array([7, 7, -1, 2**40, 7, -1]))
    assert found.tolist() == [0, 0, 1, 2, 0, 1]
    assert order.tolist() == [7, -1, 2**40]
