"""Permutations, and values numbered by their first appearance."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.polymesh.permutations import inverse, numbered


def test_values_are_numbered_by_their_first_elements() -> None:
    found, order = numbered(np.array([7, 7, -1, 2**40, 7, -1]))
    assert found.tolist() == [0, 0, 1, 2, 0, 1]
    assert order.tolist() == [7, -1, 2**40]


@given(st.integers(0, 50), st.integers(0, 2**32))
def test_an_inverse_leads_back(n: int, seed: int) -> None:
    permutation = np.random.default_rng(seed).permutation(n)
    back = inverse(permutation)
    assert back[permutation].tolist() == permutation[back].tolist() == list(range(n))
    np.testing.assert_array_equal(inverse(back), permutation)


@given(st.lists(st.integers(-3, 3) | st.integers(-(2**63), 2**63 - 1)))
def test_numbers_of_values_against_a_dictionary(values: list[int]) -> None:
    labels, order = numbered(np.array(values, dtype=np.int64))
    first = {value: label for label, value in enumerate(dict.fromkeys(values))}
    assert labels.tolist() == [first[value] for value in values]
    assert order.tolist() == list(first)
