"""How numbers are spelled: the forms in which all values of an axis can be had to the last bit.

Few of the numbers in mesh files use all the bits of their type. Text has decimals, a fixed number
of places or of digits; binary files have float32, often in float64; marching cubes make numbers of
which two in three are whole. A *form* is the set of the numbers m * base^(e - places) with |m| <
base^digits, and e = 0 unless m has as many digits: a lattice of `places` that gets coarser for
large numbers, as IEEE 754 has it for base 2. Its numbers are counted in their order by an index, as
bit patterns of floats are (P. Lindstrom, M. Isenburg, "Fast and efficient compression of
floating-point data", IEEE TVCG 2006, section 3.2).

A decimal is what a reader of text makes of it: the double next to m * 10^(e - places), and for
float32 files that rounded to float32.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.exact import BOUND, NEGATIVE_ZERO, POWERS, RAW

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int64]

# Decimals are quotients of two exact doubles, rounded once: m * 10^e < 2^53, and 10^22.
EXACT: Final = 1 << 53
DECIMAL_PLACES: Final = 22
TENS: Final = np.array([float(f"1e{k}") for k in range(DECIMAL_PLACES + 1)])
DECIMAL_DIGITS: Final = 17
# How much finer than a decimal form the grid may be.
DECIMAL_OFFSET: Final = 18
SINGLE_DIGITS: Final = 24
BINARY_DIGITS: Final = 53
# Of binary64: the exponents of the smallest number and of the unit of the largest.
MAX_PLACES: Final = 1074
MIN_PLACES: Final = -971
# Indices stay below it, so that their differences fit 64 bits.
INDEX_BITS: Final = 61
PLACE_BITS: Final = BOUND.bit_length() - 1

# Of a usual length; below, distances are asked from 0 up.
MOST_USUAL: Final = 60
LEAST_USUAL: Final = 3.5

_QUOTIENT: Final = 15  # digits of any numerator: 10^15 < 2^53
_NEVER: Final = 1 << 12  # the places and digits of a number that is no decimal
# What a form takes to tell, in bits.
_TOLD: Final = 40.0
# How many are looked at: values to choose the base, errors, lattices of base 2.
_SOME: Final = 1 << 14
_ERRORS: Final = 32
_MOST_LATTICES: Final = 64


@dataclass(frozen=True)
class Form:
    """A set of numbers; see the module."""

    base: int
    places: int
    digits: int


@dataclass(frozen=True)
class Spelling:
    """The forms of the values of an axis.

    Attributes
    ----------
    forms : tuple of Form
        Two at most, of one base. A value is in the first that has it, or raw.
    usual : tuple of int
        The usual length of a distance in each form, in bits.
    grid : int
        Predictions are made in integer multiples of base^-grid.
    raw : bool
        Whether there are values of neither form; they are coded as they are.
    zeros : bool
        Whether there are negative zeros.
    """

    forms: tuple[Form, ...]
    usual: tuple[int, ...]
    grid: int
    raw: bool
    zeros: bool


@dataclass(frozen=True)
class _Needs:
    """What it takes to spell each value in a base: v = mantissa * base^-places.

    `size` is the number of digits before the point, or less the number of zeros after it.
    """

    base: int
    mantissa: _Ints
    places: _Ints
    digits: _Ints
    size: _Ints


def largest_offset(digits: int) -> int:
    """Return by how many places a binary form may go beyond the grid; its indices stay small."""
    return (1 << (INDEX_BITS - digits)) - PLACE_BITS - 2


def spelling(values: _Floats, errors: _Floats, single: bool) -> Spelling:
    """Choose the forms of an axis that take the fewest bits, by an estimate.

    Parameters
    ----------
    values : float64 (n,)
    errors : float64 (k,)
        How far predictions are off.
    single : bool
        Whether all values are float32.
    """
    zeros = bool((np.signbit(values) & (values == 0)).any())
    raw_bits = 33.0 if single else 65.0
    sizes = errors if len(errors) else np.abs(values)
    sample = np.quantile(sizes[:: len(sizes) // _SOME + 1], (np.arange(_ERRORS) + 0.5) / _ERRORS)
    # The base is that of the best forms of some values; its best forms of all are then taken.
    some = values[:: len(values) // _SOME + 1]
    costs = {b: _best(_needs(some, b, single), sample, raw_bits)[0] for b in (2, 10)}
    base = min(costs, key=costs.__getitem__)
    needs = _needs(values, base, single)
    cost, forms = _best(needs, sample, raw_bits)
    if cost > raw_bits * len(values):
        return Spelling((), (), 0, raw=True, zeros=False)
    return _spelled(needs, forms, sample, zeros)


def to_integers(values: _Floats, how: Spelling, single: bool) -> tuple[_Ints, _Ints]:
    """Return the class of each value (see `kernels.exact`), and its index or its bits."""
    classes = np.full(len(values), RAW, dtype=np.int64)
    integers = _bits(values, single)
    if how.forms:
        needs = _needs(values, how.forms[0].base, single)
        able = _able(needs)
    for i in reversed(range(len(how.forms))):
        has = able & _has(how.forms[i], needs)
        classes[has] = i
        integers[has] = _index(how.forms[i], needs)[has]
    if how.zeros:
        negative = np.signbit(values) & (values == 0)
        classes[negative], integers[negative] = NEGATIVE_ZERO, 0
    return classes, integers


def to_values(classes: _Ints, integers: _Ints, how: Spelling, single: bool) -> _Floats:
    """Return the values: the mirror of `to_integers`; a number beyond its type is infinite."""
    values = np.zeros(len(classes))
    values[classes == RAW] = _from_bits(integers[classes == RAW], single)
    for i, form in enumerate(how.forms):
        has = classes == i
        values[has] = _number(form, integers[has], single)
    values[classes == NEGATIVE_ZERO] = -0.0
    return values


def spelling_fault(how: Spelling) -> str:
    """Tell what is wrong with a spelling from a file, by the rules of SPEC.md 5.12; else ""."""
    if len(how.forms) > 2 or not (how.forms or how.raw):
        return f"{len(how.forms)} forms of coordinates"
    for form, usual in zip(how.forms, how.usual, strict=True):
        offset = how.grid - form.places
        if form.base == 2:
            fits = MIN_PLACES <= form.places <= MAX_PLACES and 1 <= form.digits <= BINARY_DIGITS
            fits = fits and -largest_offset(form.digits) <= offset
        else:
            fits = 0 <= form.places <= DECIMAL_PLACES and 1 <= form.digits <= DECIMAL_DIGITS
            fits = fits and form.base == 10 and 0 <= offset <= DECIMAL_OFFSET
        if not fits or form.base != how.forms[0].base or usual > MOST_USUAL:
            return f"a form of coordinates that there is not: {form}"
    return ""


def _bits(values: _Floats, single: bool) -> _Ints:
    if single:
        return values.astype(np.float32).view(np.uint32).astype(np.int64)
    return values.copy().view(np.int64)


def _from_bits(integers: _Ints, single: bool) -> _Floats:
    if single:
        return (integers & 0xFFFFFFFF).astype(np.uint32).view(np.float32).astype(np.float64)
    return integers.copy().view(np.float64)


def _needs(values: _Floats, base: int, single: bool) -> _Needs:
    return _binary_needs(values) if base == 2 else _decimal_needs(values, single)


def _binary_needs(values: _Floats) -> _Needs:
    mantissa, exponent = np.frexp(values)
    size = exponent.astype(np.int64)
    m = np.ldexp(mantissa, BINARY_DIGITS).astype(np.int64)
    lowest = (m & -m).astype(np.float64)
    spare = np.where(m == 0, BINARY_DIGITS, np.frexp(lowest)[1].astype(np.int64) - 1)
    places = np.where(m == 0, -_NEVER, BINARY_DIGITS - size - spare)
    return _Needs(2, m >> spare, places, BINARY_DIGITS - spare, np.where(m == 0, -_NEVER, size))


def _decimal_needs(values: _Floats, single: bool) -> _Needs:
    """Return the shortest decimal of each value."""
    mantissa = np.zeros(len(values), dtype=np.int64)
    places = np.full(len(values), _NEVER, dtype=np.int64)
    left = np.flatnonzero(np.abs(values) < EXACT)
    for k in range(DECIMAL_PLACES + 1):
        x = values[left]
        rounded = np.rint(x * TENS[k])
        small = np.abs(rounded) < EXACT
        same = small & (_rounded(rounded / TENS[k], single) == x)
        found = left[same]
        mantissa[found], places[found] = rounded[same].astype(np.int64), k
        left = left[small & ~same]
        if not len(left):
            break
    size = np.abs(mantissa)
    length = np.searchsorted(POWERS, size, side="right")
    # Of whole numbers, the zeros at the end are no digits.
    zeros = np.zeros(len(values), dtype=np.int64)
    for power in POWERS[1:16]:
        zeros += size % power == 0
    before = np.where(size == 0, -_NEVER, length - places)
    digits = np.where(places == _NEVER, _NEVER, np.where(size == 0, 0, length - zeros))
    return _Needs(10, mantissa, places, digits, before)


def _rounded(x: _Floats, single: bool) -> _Floats:
    return x.astype(np.float32).astype(np.float64) if single else x


def _has(form: Form, needs: _Needs) -> NDArray[np.bool_]:
    reach = needs.size + form.places
    near = reach <= (1 << (INDEX_BITS - form.digits)) - 2 if form.base == 2 else reach <= _QUOTIENT
    return np.asarray((needs.places <= form.places) & (needs.digits <= form.digits) & near)


def _able(needs: _Needs) -> NDArray[np.bool_]:
    """Tell which values forms can have: those that do not reach too far below the others."""
    largest = int(needs.size.max(initial=-_NEVER))
    if needs.base == 2:
        most = PLACE_BITS - largest + largest_offset(int(needs.digits.max(initial=1)))
    else:
        most = min(DECIMAL_PLACES, _QUOTIENT - largest)
    digits = BINARY_DIGITS if needs.base == 2 else DECIMAL_DIGITS
    fit = (needs.places <= most) & (needs.digits <= digits)
    return np.asarray(fit | (needs.digits == 0))


def _index(form: Form, needs: _Needs) -> _Ints:
    """Return the indices of values that the form has; of others, anything."""
    unit = np.maximum(-form.places, needs.size - form.digits)  # the power of the base
    e = np.where(needs.mantissa == 0, 0, unit + form.places)
    up = -needs.places - unit
    m = np.abs(needs.mantissa)
    if form.base == 2:
        m = m << np.clip(up, 0, 62)
    else:
        m = m * POWERS[np.clip(up, 0, 18)] // POWERS[np.clip(-up, 0, 18)]
    index = m + e * ((form.base - 1) * form.base ** (form.digits - 1))
    return np.asarray(np.where(needs.mantissa < 0, -index, index))


def _number(form: Form, index: _Ints, single: bool) -> _Floats:
    """Return the numbers of these indices."""
    top = form.base ** (form.digits - 1)
    size = np.abs(index)
    e = np.maximum((size - top) // ((form.base - 1) * top), 0)
    m = size - e * ((form.base - 1) * top)
    sign = np.where(index < 0, -1.0, 1.0)
    with np.errstate(over="ignore"):
        if form.base == 2:
            return np.asarray(
                sign * np.ldexp(m.astype(np.float64), np.minimum(e, _NEVER) - form.places)
            )
        fits = (e <= 18) & (m < EXACT // POWERS[np.clip(e, 0, 18)])
        exact = np.where(fits, m * POWERS[np.clip(e, 0, 18)], 0).astype(np.float64)
        return sign * np.where(fits, _rounded(exact / TENS[form.places], single), np.inf)


def _best(needs: _Needs, errors: _Floats, raw_bits: float) -> tuple[float, tuple[Form, ...]]:
    """Return the forms of a base that take the fewest bits, and how many these are."""
    kinds, counts = _kinds(needs)
    able = _able(kinds)
    lengths = _Lengths(needs.base, errors)
    best: tuple[float, tuple[Form, ...]] = (np.inf, ())
    for form in _first_forms(needs.base, kinds.places[able], kinds.digits[able]):
        first = able & _has(form, kinds)
        rest = able & ~first
        forms: tuple[Form, ...] = (form,)
        shares = [int(counts[first].sum()), int(counts[~able].sum())]
        cost = counts[first] @ lengths(form, kinds.size[first]) + shares[1] * raw_bits
        if rest.any():
            places, digits = int(kinds.places[rest].max()), int(kinds.digits[rest].max())
            second = Form(needs.base, places, digits)
            forms = (form, second)
            shares.append(int(counts[rest].sum()))
            cost += counts[rest] @ lengths(second, kinds.size[rest])
        cost += _TOLD * len(forms) + _entropy(shares)
        best = min(best, (float(cost), forms), key=lambda one: one[0])
    return best


def _kinds(needs: _Needs) -> tuple[_Needs, _Ints]:
    """Return what it takes, each once, and how many values but zeros take it."""
    span = 2 * _NEVER + 1
    keys = ((needs.places + _NEVER) * span + needs.digits) * span + needs.size + _NEVER
    keys, counts = np.unique(keys[needs.digits > 0], return_counts=True)
    places, digits, size = keys // span**2 - _NEVER, keys // span % span, keys % span - _NEVER
    return _Needs(needs.base, np.ones_like(keys), places, digits, size), counts


def _first_forms(base: int, places: _Ints, digits: _Ints) -> Iterator[Form]:
    """Yield what the first form may be, where values take so much."""
    lattices = np.unique(places) if len(places) else np.zeros(1, dtype=np.int64)
    if base == 10:
        lattices = lattices[lattices >= lattices[-1] - DECIMAL_OFFSET]
        numbers = np.unique(digits) if len(digits) else np.ones(1, dtype=np.int64)
    else:
        every = len(lattices) // _MOST_LATTICES + 1
        lattices = lattices[::-every]
        numbers = np.unique(np.minimum(digits.max(initial=1), [SINGLE_DIGITS, BINARY_DIGITS]))
    for k in lattices:
        for p in numbers:
            yield Form(base, int(k), int(p))


class _Lengths:
    """How many bits distances take, about: log2(1 + error / unit), the mean over a sample."""

    def __init__(self, base: int, errors: _Floats) -> None:
        self.base = float(np.log2(base))
        with np.errstate(divide="ignore"):
            self.errors = np.log2(errors)

    def __call__(self, form: Form, size: _Ints) -> _Floats:
        """Return that for values of these sizes."""
        units = np.maximum(-form.places, size - form.digits) * self.base
        return np.asarray(np.logaddexp2(0.0, self.errors - units[:, None]).mean(axis=1))


def _entropy(shares: list[int]) -> float:
    total = sum(shares)
    return sum(s * float(np.log2(total / s)) for s in shares if s)


def _spelled(needs: _Needs, forms: tuple[Form, ...], errors: _Floats, zeros: bool) -> Spelling:
    """Return the spelling in these forms."""
    grid = max(form.places for form in forms)
    if needs.base == 2:
        grid = min(grid, PLACE_BITS - int(needs.size.max(initial=-_NEVER)))
    usual, left = [], _able(needs)
    raw = bool((~left).any())
    lengths = _Lengths(needs.base, errors)
    for form in forms:
        has = left & _has(form, needs)
        left &= ~has
        sizes, counts = np.unique(needs.size[has & (needs.digits > 0)], return_counts=True)
        mean = counts @ lengths(form, sizes) / counts.sum() if len(sizes) else 0.0
        usual.append(min(round(float(mean)), MOST_USUAL) if mean >= LEAST_USUAL else 0)
    return Spelling(forms, tuple(usual), grid, raw, zeros)
