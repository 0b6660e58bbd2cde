"""Guesses of conversions, and the differences of floats that they come from."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from converted_numbers import as_single, made, walk
from hypothesis import given
from hypothesis import strategies as st

from deltamesh._streams.conversion_search import Guess, _differences, guesses
from deltamesh._streams.conversions import ADD, DIVIDE, MULTIPLY
from deltamesh._streams.lattices import find_lattice

ORIGINS = 1 << 15


def guessed(values: np.ndarray, single: bool) -> list[Guess]:
    lattice = find_lattice(values, single)
    assert lattice is not None
    return list(guesses(values[:400], lattice, single, ORIGINS))


def operations(guess: Guess) -> list[tuple[int, float]]:
    return [(one.operator, one.operand) for one in guess[1].operations]


@pytest.mark.parametrize(
    ("kind", "operator", "operand"),
    [
        ("* 0.001", MULTIPLY, float(as_single(0.001))),
        ("* 25.4", MULTIPLY, float(as_single(25.4))),
        ("/ 1000", DIVIDE, 1000.0),
        ("/ 1000, float64", DIVIDE, 1000.0),
        ("* 0.0254, float64", MULTIPLY, 0.0254),
    ],
)
def test_the_constant_is_among_the_guesses(kind: str, operator: int, operand: float) -> None:
    single, values = made(kind, 2000)
    found = [operations(guess) for guess in guessed(values, single) if guess[0] == 3]
    assert [(operator, operand)] in found


def test_the_origin_and_the_step_of_a_grid_are_among_the_guesses() -> None:
    k = np.rint(1000 * walk(2000, 0))
    k -= k.min()
    step, origin = float(as_single(0.0123)), float(as_single(-3.77))
    values = as_single(as_single(k * step) + origin)
    lattice = find_lattice(values, single=True)
    assert lattice is not None
    some = np.append(values[:400], values.min())
    found = [operations(guess) for guess in guesses(some, lattice, True, ORIGINS)]
    assert [(MULTIPLY, step), (ADD, origin)] in found


def test_halves_and_quarters_of_a_place_are_quotients_of_whole_numbers() -> None:
    values = np.rint(walk(2000, 4) * 400) / 400 - 1 / 3
    found = [operations(guess) for guess in guessed(values, single=False)]
    assert any(some[:1] == [(DIVIDE, 400.0)] and len(some) == 2 for some in found)


@given(st.data())
def test_differences_of_differences_are_rounded_once(data: st.DataObject) -> None:
    numbers = st.floats(-1e9, 1e9)
    values = np.array(data.draw(st.lists(numbers, min_size=2, max_size=5)))
    sources = np.array([[data.draw(numbers)] for _ in values])
    first, rest = _differences(values, sources)
    assert first[0] == values[0] - sources[0, 0]
    for value, source, found in zip(values, sources[:, 0], rest[:, 0], strict=True):
        exact = Fraction(value) - Fraction(source) - Fraction(float(first[0]))
        assert abs(Fraction(float(found)) - exact) <= abs(exact) * Fraction(1, 2**51)
