"""Search of the conversion that made the values of a column, on a lattice that most are near.

Each kind of conversion is a guess with unknown operands. A value says of an operand in which
interval it is, by the rounding of the result; the operand is a number in the intersection of the
intervals of some values, the shortest decimal in it if there are several. Whether a guess is
right is then seen by the deviations of other values.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from deltamesh._streams.conversions import ADD, DIVIDE, MULTIPLY, Conversion, Operation, converted
from deltamesh._streams.decomposition import TENS, rounded_to
from deltamesh._streams.lattices import Lattice, units
from deltamesh_formats.array_types import Floats, Ints

# A conversion of numbers of so many decimal places.
Guess = tuple[int, Conversion]

# Decimal places of numbers that were multiplied or divided.
_MOST_PLACES: Final = 9
# Digits of a decimal that a lattice is divided by.
_MOST_DIGITS: Final = 3
# First multiples are tried so many at once in each direction, with ever more of the values.
_AT_ONCE: Final = 1 << 11
_SOME: Final = (3, 12, 48)
# Neighbours, in their type, of an operand that are tried.
_NEIGHBOURS: Final = 6
# First multiples that fit, and are tried, of so many at once.
_MOST_MOVED: Final = 4
# Values whose differences bound a slope; those added to them, so many times, where it is wrong.
_PAIRED: Final = 160
_ROUNDS: Final = 6
_WORST: Final = 32


def guesses(values: Floats, lattice: Lattice, single: bool, origins: int) -> Iterator[Guess]:
    """Yield conversions that may have made values, the simplest first.

    Parameters
    ----------
    values : float64 (n,)
        Some that are near the lattice.
    lattice : Lattice
    single : bool
        Whether all values of the column are float32.
    origins : int
        Effort: how many numbers an addition may have begun with.
    """
    k, _ = lattice.multiples(values)
    if k.min() == k.max():  # all are at one point of the lattice, which says nothing of them
        return
    yield from _scaled(values, lattice, single)
    yield from _dequantized(values, k, lattice, single)
    yield from _linear(values, k, lattice, single)
    yield from _moved(values, k, lattice, single, origins)


def _scaled(values: Floats, lattice: Lattice, single: bool) -> Iterator[Guess]:
    """Yield products of decimals, and quotients of them, with a constant."""
    multiples = np.rint(values / lattice.step)
    error = np.abs(values - multiples * lattice.step)
    if (error > 0.25 * lattice.step).mean() > 0.1:
        return
    used = np.abs(multiples) > 0
    if not used.any():  # all are far below the step
        return
    size, m = np.abs(values[used]), np.abs(multiples[used])
    half = units(size, single) / 2
    for places in range(_MOST_PLACES + 1):
        x = rounded_to(m / TENS[places], single)
        for factor in _operands((size - half) / x, (size + half) / x, single):
            yield places, _of((MULTIPLY, factor))
        for divisor in _operands(x / (size + half), x / (size - half), single):
            yield places, _of((DIVIDE, divisor))


def _moved(
    values: Floats, k: Ints, lattice: Lattice, single: bool, origins: int
) -> Iterator[Guess]:
    """Yield sums of decimals and a constant; the decimals are rounded before."""
    decimals = _decimals_of(lattice)
    if decimals is None:
        return
    places, before = decimals
    conversion = _of(*before)

    def sources_of(multiples: Floats) -> Floats:
        return converted(rounded_to(multiples / TENS[places], single), conversion, single)

    # Small values say most: little of them is lost by rounding.
    order = np.argsort(np.abs(values), kind="stable")
    v, m = values[order], k[order].astype(np.float64)
    half = units(v, single) / 2
    # About 0, so that the multiples of decimals that are near come first.
    shift = int(np.rint(lattice.origin / lattice.step))
    for begin in range(0, origins, _AT_ONCE):
        some = np.arange(begin, begin + _AT_ONCE, dtype=np.float64)
        some = np.concatenate([-some[::-1], some]) + shift
        for count in (*_SOME, len(v)):
            _, rest = _differences(v[:count], sources_of(np.add.outer(m[:count], some)))
            slack = half[:count, None]
            some = some[(rest - slack).max(axis=0) <= (rest + slack).min(axis=0)]
            if not len(some):
                break
        else:
            for operand in _addends(v, sources_of(np.add.outer(m, some)), half, single):
                yield places, _of(*before, (ADD, operand))


def _addends(values: Floats, sources: Floats, half: Floats, single: bool) -> Iterator[float]:
    """Yield what added to sources (n, c) makes most of the values (n,), of the best columns."""
    first, rest = _differences(values, sources)
    low, high = rest - half[:, None], rest + half[:, None]
    middle = first + (low.max(axis=0) + high.min(axis=0)) / 2
    results = rounded_to(sources + rounded_to(middle, single), single)
    best = np.argsort((results != values[:, None]).sum(axis=0), kind="stable")
    for i in best[:_MOST_MOVED]:
        yield from _operands(first[i] + low[:, i], first[i] + high[:, i], single)


def _differences(values: Floats, sources: Floats) -> tuple[Floats, Floats]:
    """Return the first difference of each column, float64 (c,), and all of them less that one.

    Differences of values (n,) and sources (n, c) are rounded, but not what is returned: the error
    is known by D. E. Knuth's sum of two floats ("The art of computer programming", vol. 2, 4.2.2).
    """
    v = values[:, None]
    difference = v - sources
    moved = difference - v
    error = (v - (difference - moved)) - (sources + moved)
    return difference[0], (difference - difference[0]) + error


def _decimals_of(lattice: Lattice) -> tuple[int, tuple[tuple[int, float], ...]] | None:
    """Return places of numbers with the step of a lattice, and the operations that make them.

    A step may be that of decimals, or of whole numbers divided by a decimal of few digits.
    """
    places = max(int(np.rint(-np.log10(lattice.step))), 0)
    if places < len(TENS) and abs(lattice.step * TENS[places] - 1) <= lattice.tolerance:
        return places, ()
    inverse = 1 / lattice.step
    for digits in range(1, _MOST_DIGITS + 1):
        divisor = float(f"{inverse:.{digits - 1}e}")
        if abs(divisor / inverse - 1) <= lattice.tolerance:
            return 0, ((DIVIDE, divisor),)
    return None


def _dequantized(values: Floats, k: Ints, lattice: Lattice, single: bool) -> Iterator[Guess]:
    """Yield sums of a multiple of a step, rounded before, and the value of the multiple 0."""
    lowest = k.min()
    m = (k - lowest).astype(np.float64)
    origin = float(values[np.argmin(k)])
    used = m > 0
    v, m = values[used], m[used]
    # Both roundings may have moved a value, and that of the difference here.
    slack = units(v, single) / 2 + units(v - origin, single)
    low, high = ((v - origin - slack) / m).max(), ((v - origin + slack) / m).min()
    if not 0 < low <= high or not origin:
        return
    middle = (low + high) / 2
    near = rounded_to(np.array([middle]), single)[0]
    unit = float(units(np.array([near]), single)[0])
    steps = [near + i * unit for i in range(-_NEIGHBOURS, _NEIGHBOURS + 1)]
    for step in sorted(steps, key=lambda one: abs(one - middle)):
        if low - unit <= step <= high + unit:
            yield 0, _of((MULTIPLY, step), (ADD, origin))


def _linear(values: Floats, k: Ints, lattice: Lattice, single: bool) -> Iterator[Guess]:
    """Yield linear functions of the multiples, rounded once."""
    half = units(values, single) / 2
    order = np.argsort(k, kind="stable")
    chosen = order[np.linspace(0, len(values) - 1, min(len(values), _PAIRED)).astype(np.int64)]
    for _ in range(_ROUNDS):
        v, m, h = values[chosen], k[chosen].astype(np.float64), half[chosen]
        gap = m[:, None] - m
        rise, slack = v[:, None] - v, h[:, None] + h
        with np.errstate(divide="ignore", invalid="ignore"):
            high = np.where(gap > 0, (rise + slack) / gap, np.inf).min()
            low = np.where(gap > 0, (rise - slack) / gap, -np.inf).max()
        if low > high:
            break
        slope = float((low + high) / 2)
        rest = v - m * slope
        origin = float(((rest - h).max() + (rest + h).min()) / 2)
        wrong = np.abs(values - (k * slope + origin)) - half
        worst = np.argsort(-wrong)[:_WORST]
        if wrong[worst[0]] <= 0:
            yield 0, _of((MULTIPLY, slope), (ADD, origin), double=single)
            return
        chosen = np.concatenate([chosen, worst])
    yield 0, _of((MULTIPLY, lattice.step), (ADD, lattice.origin), double=single)


def _of(*operations: tuple[int, float], double: bool = False) -> Conversion:
    some = tuple(Operation(operator, float(operand)) for operator, operand in operations)
    return Conversion(some, double, deviations=False)


def _operands(low: Floats, high: Floats, single: bool) -> Iterator[float]:
    """Yield operands in an intersection of intervals: a short decimal, and floats in its middle."""
    with np.errstate(invalid="ignore"):
        a, b = float(low.max()), float(high.min())
    middle = (a + b) / 2
    unit = float(np.spacing(abs(middle)))
    if not (a <= b + 2 * unit and abs(middle) > 0):
        return
    a, b = a - unit, b + unit
    short = (float(f"{middle:.{digits}e}") for digits in range(17))
    yield next((x for x in short if a <= x <= b), middle)
    if single:
        yield float(np.float32(middle))
    elif b - a < 16 * unit:
        yield from (middle + i * unit for i in (0, 1, -1, 2, -2))
