"""Texts of numbers: read back, they are the same numbers, and none is longer than it must be."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh_formats.meshfiles.number_text import number_texts, rounded, row_texts, with_places

KINDS = ("f2", "f4", "f8", "i4", "u1", "i8")


@given(st.sampled_from(KINDS), st.data())
def test_numbers_come_back(kind: str, data: st.DataObject) -> None:
    values = data.draw(nps.arrays(kind, st.integers(0, 8)))
    texts = number_texts(values)
    back = [np.dtype(kind).type(text) for text in texts]
    found = np.array(back, dtype=kind)
    assert np.array_equal(found, values, equal_nan=kind[0] == "f")
    has_sign = ~np.isnan(values)  # that of a NaN has no text
    assert (np.signbit(found) == np.signbit(values))[has_sign].all()


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (np.float64(0.1), "0.1"),
        (np.float32(0.1), "0.10000000149011612"),
        (np.float32(0.125), "0.125"),
        (np.float64(-3.0), "-3"),
        (np.float64(-0.0), "-0"),
        (np.float64(1e22), "1e+22"),
        (np.uint8(200), "200"),
    ],
)
def test_texts_are_the_shortest_of_the_float64(value: np.generic, text: str) -> None:
    assert number_texts(np.array([value])) == [text]


@given(
    nps.arrays("f8", st.integers(1, 8), elements=st.floats(allow_nan=True, allow_infinity=True)),
    st.floats(1e-320, 1e300),
)
def test_rounding_moves_no_number_by_more_than_the_margin(values: Any, margin: float) -> None:
    found = rounded(values, margin)
    finite = np.isfinite(values)
    with np.errstate(all="ignore"):
        assert (np.abs(found - values)[finite] <= margin).all()
    assert np.array_equal(found[~finite], values[~finite], equal_nan=True)


@given(st.floats(-1, 1), st.floats(1e-14, 1e-2), st.integers(-250, 250))
def test_a_rounded_number_has_the_digits_of_its_margin(x: float, margin: float, e: int) -> None:
    """A step of the last digit is more than a fifth of the margin, at any scale."""
    scale = 10.0**e
    (text,) = number_texts(rounded(np.array([x * scale]), margin * scale))
    exponent = Decimal(text).normalize().as_tuple().exponent
    assert isinstance(exponent, int)
    assert Decimal(text) == 0 or 10.0 ** (exponent - e) > 0.199 * margin


def test_what_has_no_margin_stays() -> None:
    for values in (np.array([0.1, -0.0, np.nan]), np.array([1, 2]), np.array([1.5], dtype="f4")):
        assert rounded(values, 0.0) is values
    whole = np.array([1234567])
    assert rounded(whole, 1000.0) is whole


@pytest.mark.parametrize(
    ("margin", "text"), [(0.1, "0.1"), (0.0005, "0.123"), (0.005, "0.12"), (0.6, "0"), (1e3, "0")]
)
def test_rounded_numbers_are_decimals(margin: float, text: str) -> None:
    for kind in ("f2", "f4", "f8"):
        assert number_texts(rounded(np.array([0.1234], dtype=kind), margin)) == [text]


def test_places_are_those_after_the_point() -> None:
    values = np.array([4123456.123456, -0.0004, 2.0])
    assert number_texts(with_places(values, 3)) == ["4123456.123", "0", "2"]
    assert number_texts(with_places(values, 0)) == ["4123456", "0", "2"]
    assert number_texts(with_places(values, 20)) == ["4123456.123456", "-0.0004", "2"]


def test_whole_floats_have_a_point_where_that_matters() -> None:
    assert number_texts(np.array([1.0, 0.5]), points=True) == ["1.0", "0.5"]
    assert row_texts(np.array([[1.0, 0.5]]), points=True) == ["1.0 0.5"]


def test_rows_have_spaces_between() -> None:
    assert row_texts(np.array([[1, 2], [3, 4]])) == ["1 2", "3 4"]
    assert row_texts(np.zeros((0, 3))) == []
