"""Decomposition of numbers: the shortest mantissa of each, in base 2 and in base 10."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from exact_numbers import decimals, doubles, dyadics, extremes, singles
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._streams.decomposition import NEVER, decompose, rounded_to

values = st.lists(st.one_of(doubles, singles, decimals, dyadics, extremes), min_size=1)


@given(values, st.sampled_from([2, 10]))
def test_a_decomposition_is_the_number(numbers: list[float], base: int) -> None:
    parts = decompose(np.array(numbers), base, single=False)
    assert parts.base == base
    rows = zip(numbers, parts.mantissa, parts.places, parts.digits, parts.size, strict=True)
    for x, *row in rows:
        m, places, digits, size = map(int, row)
        if places == NEVER:
            assert base == 10
            continue
        assert float(m * Fraction(base) ** -places) == x
        if not m:
            assert x == 0
            continue
        assert m % base or (base == 10 and places == 0)  # whole decimals keep their zeros
        assert digits == length(abs(m), base) - trailing_zeros(abs(m), base)
        assert size == length(abs(m), base) - places


def length(m: int, base: int) -> int:
    """Digits of a number."""
    return 0 if not m else 1 + length(m // base, base)


def trailing_zeros(m: int, base: int) -> int:
    return 0 if m % base else 1 + trailing_zeros(m // base, base)


@pytest.mark.parametrize(
    ("x", "mantissa", "places"), [(0.25, 25, 2), (-3.5, -35, 1), (1200.0, 1200, 0), (1e-7, 1, 7)]
)
def test_decimals_by_hand(x: float, mantissa: int, places: int) -> None:
    parts = decompose(np.array([x]), 10, single=False)
    assert (parts.mantissa[0], parts.places[0]) == (mantissa, places)


def test_numbers_of_more_digits_than_a_double_holds_are_no_decimals() -> None:
    x = np.array([0.1 + 0.2, 1e200, 1e-30])
    assert decompose(x, 10, single=False).places.tolist() == [NEVER] * 3


def test_decimals_of_singles_are_rounded_as_these() -> None:
    x = np.array([float(np.float32(0.1))])
    assert decompose(x, 10, single=True).places[0] == 1
    assert decompose(x, 10, single=False).places[0] > 1
    assert rounded_to(np.array([0.1]), single=True)[0] == np.float32(0.1)
    assert rounded_to(np.array([0.1]), single=False)[0] == 0.1
