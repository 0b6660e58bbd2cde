"""Conversions are found that made a column, and others are left alone."""

from __future__ import annotations

import numpy as np
import pytest
from converted_numbers import KINDS, Column, as_single, made, walk

from deltamesh._kernels.coding.exact import RAW
from deltamesh._streams.conversion_choice import choose_conversion
from deltamesh._streams.format_choice import choose_formats
from deltamesh._streams.lattices import find_lattice
from deltamesh._streams.number_formats import ColumnFormats, fault_of, from_indices, to_indices


def chosen(values: Column, single: bool) -> tuple[ColumnFormats, float]:
    """The formats, and the bits of a value that they save."""
    errors = np.abs(values[2:] - 2 * values[1:-1] + values[:-2])
    cost, plain = choose_formats(values, errors, single)
    less, column = choose_conversion(values, errors, single, cost, plain)
    found = to_indices(values, column, single)
    assert from_indices(*found, column, single).tobytes() == values.tobytes()
    assert column.raw == (found[0] == RAW).any()
    assert column.conversion.deviations == found[2].any()
    return column, (cost - less) / len(values)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("count", [600, 5000])
def test_what_made_a_column_is_found(kind: str, count: int) -> None:
    single, values = made(kind, count)
    column, saved = chosen(values, single)
    assert column.conversion.operations
    assert not column.conversion.deviations
    assert not column.raw
    assert saved > (1.5 if single else 10)


def test_values_off_the_lattice_cost_themselves_alone() -> None:
    rng = np.random.default_rng(5)
    single, values = made("* 25.4", 5000)
    values = np.where(rng.random(5000) < 0.01, as_single(values + rng.normal(size=5000)), values)
    column, saved = chosen(values, single)
    assert column.conversion.operations[0].operand == pytest.approx(25.4, rel=1e-6)
    deviations = to_indices(values, column, single)[2]
    assert 0.005 < (deviations != 0).mean() < 0.02
    assert saved > 5


def test_another_rounding_is_a_deviation_of_few_floats() -> None:
    """Three operations are more than a conversion has."""
    decimals = as_single(walk(5000, 1).round(3))
    values = as_single(as_single(as_single(decimals / 7) * as_single(0.3)) - as_single(0.7))
    column, saved = chosen(values, single=True)
    choices, _, deviations = to_indices(values, column, single=True)
    assert not (choices == RAW).any()
    assert np.median(np.abs(deviations)) <= 2
    assert saved > 3


def test_subnormal_numbers_and_negative_zeros_come_back() -> None:
    single, values = made("* 0.001", 3000)
    values[::50], values[7], values[8] = -0.0, 2.0**-149, -(2.0**-149)
    assert chosen(values, single)[0].conversion.operations


@pytest.mark.parametrize("single", [True, False])
def test_noise_has_no_lattice(single: bool) -> None:
    values = walk(4000, 2)
    values = as_single(values) if single else values
    assert find_lattice(values, single) is None
    assert not chosen(values, single)[0].conversion.operations


@pytest.mark.parametrize("count", [0, 1, 2, 23, 5000])
def test_constant_and_short_columns_are_left_alone(count: int) -> None:
    values = np.full(count, 0.1)
    assert find_lattice(values, single=False) is None
    assert find_lattice(made("* 25.4", max(count, 3))[1][: min(count, 20)], True) is None


@pytest.mark.parametrize("exponent", [-1060, -1000, -500, 0, 300, 480])
def test_numbers_near_the_ends_of_their_type_come_back(exponent: int) -> None:
    """Products of a power of two: some operands would be out of range."""
    _, values = made("* 25.4, float64", 2000)
    values = np.ldexp(values, exponent)
    errors = np.abs(np.diff(values))
    cost, plain = choose_formats(values, errors, False)
    _, column = choose_conversion(values, errors, False, cost, plain)
    assert not fault_of(column, single=False)
    found = to_indices(values, column, single=False)
    assert from_indices(*found, column, single=False).tobytes() == values.tobytes()


def test_decimals_are_a_lattice_already() -> None:
    column, saved = chosen(walk(3000, 3).round(3), single=False)
    assert not column.conversion.operations
    assert saved == 0


@pytest.mark.parametrize(("bits", "seed"), [(b, s) for b in (9, 11, 13, 15) for s in range(3)])
def test_the_step_of_a_lattice_is_as_exact_as_its_values(bits: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    step, origin = rng.uniform(0.01, 3, 2)
    values = as_single(rng.integers(0, 2**bits, 700) * step + origin)
    lattice = find_lattice(values, single=True)
    assert lattice is not None
    assert lattice.step == pytest.approx(step, rel=4 * lattice.tolerance)
    multiples, near = lattice.multiples(values)
    assert near.all()
    assert np.ptp(multiples) == round(np.ptp(values) / step)
