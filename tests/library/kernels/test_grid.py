"""Numbers of a format next to a point of the grid, against fractions."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._kernels.coding import grid as kernels
from deltamesh._kernels.coding.grid import in_units, index_at, point_of
from deltamesh._streams.number_formats import ColumnFormats, NumberFormat, from_indices

FORMATS = [(2, 0, 4), (2, 3, 24), (2, -3, 24), (2, 10, 53), (10, 0, 3), (10, 2, 5), (10, 0, 17)]


def table_of(base: int, offset: int, digits: int) -> np.ndarray:
    return np.array([[base, offset, digits, 0]])


@given(st.sampled_from(FORMATS), st.integers(-(2**50), 2**50) | st.integers(-99, 99))
def test_the_number_next_to_a_point_is_half_a_unit_from_it(
    f: tuple[int, int, int], point: int
) -> None:
    base, offset, digits = f
    table = table_of(*f)
    index, unit = map(int, index_at(table, 0, point))
    # The number as the number formats have it, of no places; the grid has as many as the offset.
    how = ColumnFormats((NumberFormat(base, 0, digits),), (0,), offset, raw=False, zeros=False)
    choice = np.zeros(1, dtype=np.int64)
    found = from_indices(choice, np.array([index]), choice, how, single=False)
    number = Fraction(float(found[0]))
    number *= Fraction(base) ** offset
    assert abs(number - point) <= Fraction(base) ** unit / 2 + abs(Fraction(point)) / 2**50
    assert int(index_at(table, 0, -point)[0]) == -index


@given(st.sampled_from(FORMATS), st.integers(-(2**50), 2**50) | st.integers(-99, 99))
def test_points_of_numbers_are_fixed(f: tuple[int, int, int], point: int) -> None:
    table = table_of(*f)
    index = int(index_at(table, 0, point)[0])
    there = int(point_of(table, 0, index))
    assert int(index_at(table, 0, there)[0]) == index
    assert abs(there) <= kernels.BOUND
    assert int(point_of(table, 0, -index)) == -there


@pytest.mark.parametrize("base", [2, 10])
def test_numbers_beyond_the_grid_are_at_its_bound(base: int) -> None:
    assert int(point_of(table_of(base, 0, 3), 0, 2**40)) == kernels.BOUND
    assert int(point_of(table_of(base, 0, 3), 0, -(2**40))) == -kernels.BOUND


def test_sizes_in_units_by_hand() -> None:
    assert in_units(table_of(10, 0, 5), 0, 2, 1234) == 12
    assert in_units(table_of(2, 0, 5), 0, 3, 100) == 12
    assert in_units(table_of(2, 0, 5), 0, -3, 5) == 40
