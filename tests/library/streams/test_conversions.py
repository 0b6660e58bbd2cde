"""Conversions: each operation rounded once, ordinals of floats, and every bit of any value back."""

from __future__ import annotations

import struct
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from exact_numbers import decimals, doubles, extremes, singles
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding.exact import RAW
from deltamesh._streams.conversions import (
    ADD,
    DIVIDE,
    MULTIPLY,
    Conversion,
    Operation,
    converted,
    from_ordinals,
    ordinals,
)
from deltamesh._streams.number_formats import (
    ColumnFormats,
    NumberFormat,
    from_indices,
    to_indices,
)

operands = st.one_of(st.sampled_from([0.001, 25.4, -0.3048, 1e-300, 1e150]), doubles).filter(
    lambda x: 2.0**-1022 <= abs(x) <= 1e150
)
operations = st.builds(Operation, st.sampled_from([ADD, MULTIPLY, DIVIDE]), operands)
conversions = st.builds(
    lambda some, double, deviations: Conversion(tuple(some), double and len(some) == 2, deviations),
    st.lists(operations, max_size=2),
    st.booleans(),
    st.booleans(),
)
formats = st.one_of(
    st.builds(NumberFormat, st.just(10), st.integers(0, 22), st.integers(1, 17)),
    st.builds(NumberFormat, st.just(2), st.integers(-40, 60), st.integers(1, 53)),
)


def rounded(exact: Fraction, single: bool) -> float:
    """The float next to a number, of two the even one."""
    digits, least = (24, -149) if single else (53, -1074)
    if exact == 0:
        return 0.0
    size = abs(exact)
    exponent = size.numerator.bit_length() - size.denominator.bit_length()
    exponent -= size < Fraction(2) ** exponent
    unit = Fraction(2) ** max(exponent - digits + 1, least)
    nearest = round(exact / unit) * unit  # of two the even one
    return float(nearest)


@given(st.one_of(decimals, singles), operations, st.booleans())
def test_an_operation_is_rounded_once_in_each_type(
    number: float, operation: Operation, single: bool
) -> None:
    x, y = Fraction(number), Fraction(operation.operand)
    exact = {ADD: x + y, MULTIPLY: x * y, DIVIDE: x / y}[operation.operator]
    if abs(exact) >= 2**127:
        return
    expected = rounded(exact, single=False)
    if single:
        expected = rounded(Fraction(expected), single=True)
    one = Conversion((operation,), double=False, deviations=False)
    assert converted(np.array([number]), one, single)[0] == expected


def test_binary64_in_between_is_rounded_at_the_end_alone() -> None:
    """1 / 41 is the first quotient of which float32 makes less than 1 again."""
    both = (Operation(DIVIDE, 41.0), Operation(MULTIPLY, 41.0))
    early, late = (Conversion(both, double=double, deviations=False) for double in (False, True))
    x = np.array([1.0])
    assert converted(x, late, single=True)[0] == 1
    assert converted(x, early, single=True)[0] == np.nextafter(np.float32(1), np.float32(0))
    assert converted(x, early, single=False)[0] == 1


@given(st.one_of(doubles, extremes), st.booleans())
def test_ordinals_count_floats(x: float, single: bool) -> None:
    with np.errstate(over="ignore", under="ignore"):
        value = float(np.float32(x)) if single else x
    if not np.isfinite(value):
        return
    (place,) = ordinals(np.array([value]), single)
    assert struct.pack("d", from_ordinals(np.array([place]), single)[0]) == struct.pack("d", value)
    if value:
        kind = np.float32 if single else np.float64
        above = float(np.nextafter(kind(value), kind(np.inf)))
        if above and np.isfinite(above):
            assert ordinals(np.array([above]), single)[0] == place + 1


@pytest.mark.parametrize("single", [True, False])
def test_zeros_have_neighbouring_ordinals_and_beyond_the_largest_is_infinite(single: bool) -> None:
    assert ordinals(np.array([0.0, -0.0]), single).tolist() == [0, -1]
    largest = float(np.finfo(np.float32 if single else np.float64).max)
    for sign in (1, -1):
        place = int(ordinals(np.array([sign * largest]), single)[0])
        assert from_ordinals(np.array([place]), single)[0] == sign * largest
        assert from_ordinals(np.array([place + sign]), single)[0] == np.inf


@given(st.data(), formats, conversions, st.booleans())
def test_any_values_come_back(
    data: st.DataObject, number_format: NumberFormat, conversion: Conversion, single: bool
) -> None:
    """Those of the conversion, their neighbours, ties, subnormal numbers, zeros and others."""
    kind = np.float32 if single else np.float64
    numbers = data.draw(st.lists(st.one_of(decimals, extremes, singles), min_size=1, max_size=9))
    results = converted(np.array(numbers), conversion, single)
    others = data.draw(st.lists(st.one_of(doubles, singles, extremes), max_size=9))
    with np.errstate(over="ignore", under="ignore"):
        results = results.astype(kind)
        near = np.nextafter(results, kind(np.inf))
        between = (results.astype(np.float64) / 2 + near / 2).astype(kind)
        V = np.concatenate([results, near, between, np.array(others).astype(kind)])
        V = V.astype(np.float64)
    V = V[np.abs(V) <= 1e150]
    column = ColumnFormats(
        (number_format,), (0,), number_format.places, raw=True, zeros=False, conversion=conversion
    )
    if conversion.identical:
        column = replace(column, zeros=True)
    found = to_indices(V, column, single)
    assert from_indices(*found, column, single).tobytes() == V.tobytes()
    choices, indices, deviations = found
    assert conversion.deviations or not deviations.any()
    assert not deviations[choices == RAW].any()
    assert (np.abs(deviations) < 2**31).all()
    assert (np.abs(indices[choices != RAW]) < 2**61).all()


def test_what_overflows_on_its_way_is_infinite() -> None:
    large = (Operation(MULTIPLY, 1e150), Operation(DIVIDE, 1e150))
    for deviations in (True, False):
        conversion = Conversion(large, double=False, deviations=deviations)
        column = ColumnFormats((NumberFormat(10, 0, 17),), (0,), 0, True, False, conversion)
        one = np.ones(1, dtype=np.int64)
        values = from_indices(0 * one, one, deviations * one, column, single=True)
        assert values[0] == np.inf
