"""Number formats: an index counts their numbers, and leads back."""

from __future__ import annotations

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
from exact_numbers import decimals, doubles, dyadics, extremes, singles
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh._kernels.coding.exact import NEGATIVE_ZERO, RAW
from deltamesh._streams.format_choice import choose_formats
from deltamesh._streams.number_formats import (
    ColumnFormats,
    NumberFormat,
    fault_of,
    from_indices,
    largest_offset,
    to_indices,
)


def every_number(form: NumberFormat, exponents: int) -> list[Fraction]:
    """The definition of SPEC.md 5.12, one by one."""
    b, d = form.base, form.digits
    found = {
        Fraction(m) * Fraction(b) ** (e - form.places)
        for e in range(exponents)
        for m in range(b ** (d - 1) if e else 0, b**d)
    }
    return sorted(found | {-x for x in found})


@pytest.mark.parametrize(
    "form",
    [
        NumberFormat(2, 3, 4),
        NumberFormat(2, -2, 1),
        NumberFormat(2, 60, 2),
        NumberFormat(10, 2, 2),
        NumberFormat(10, 5, 1),
    ],
)
def test_an_index_counts_the_numbers_of_a_form(form: NumberFormat) -> None:
    expected = every_number(form, 5)
    values = np.array([float(x) for x in expected])
    how = ColumnFormats((form,), (0,), form.places, raw=False, zeros=False)
    classes, indices, deviations = to_indices(values, how, single=False)
    assert not classes.any()
    half = len(expected) // 2
    assert indices.tolist() == list(range(-half, half + 1))
    assert not deviations.any()
    assert from_indices(classes, indices, deviations, how, single=False).tolist() == values.tolist()
    between = (values[1:] + values[:-1]) / 2
    assert (to_indices(between, how, single=False)[0] == RAW).all()


@settings(deadline=None)
@given(st.lists(st.one_of(doubles, singles, decimals, dyadics, extremes), min_size=1))
def test_formats_and_back(values: list[float]) -> None:
    V = np.array(values)
    with np.errstate(over="ignore"):
        single = bool((V.astype(np.float32) == V).all())
    _, how = choose_formats(V, np.abs(V), single)
    classes, integers, deviations = to_indices(V, how, single)
    assert not deviations.any()
    assert from_indices(classes, integers, deviations, how, single).tobytes() == V.tobytes()
    assert ((classes == NEGATIVE_ZERO) <= how.zeros).all()
    assert (np.abs(integers[classes < RAW]) < 2**61).all()


def test_indices_of_binary_formats_are_kept_small() -> None:
    """A grid of 2^-grid, and numbers with so many places more, still fit 61 bits."""
    for digits in (1, 24, 53):
        most = largest_offset(digits)
        good = ColumnFormats((NumberFormat(2, 0, digits),), (0,), -most, raw=False, zeros=False)
        assert fault_of(good, single=False) == ""
        assert "invalid number format" in fault_of(
            dataclasses.replace(good, grid=-most - 1), single=False
        )


def test_a_number_beyond_its_type_is_infinite() -> None:
    how = ColumnFormats((NumberFormat(2, -971, 53),), (0,), 0, raw=False, zeros=False)
    zero = np.zeros(1, dtype=np.int64)
    assert from_indices(zero, np.array([1 << 60]), zero, how, single=False)[0] == np.inf
    assert from_indices(zero, np.array([-(1 << 60)]), zero, how, single=False)[0] == -np.inf
