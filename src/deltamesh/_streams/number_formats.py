"""Number formats: sets of numbers that hold all values of a column to the last bit.

Few of the numbers in mesh files use all the bits of their type. Text has decimals, with a fixed
number of places or of digits; binary files have float32, often in float64; marching cubes make
numbers of which two in three are whole. A *number format* is the set of the numbers
m * base^(e - places) with |m| < base^digits, where e = 0 unless m has as many digits: a lattice of
`places` that gets coarser for large numbers, as IEEE 754 has it for base 2. An index counts the
numbers of a format in ascending order, as bit patterns of floats do (P. Lindstrom, M. Isenburg,
"Fast and efficient compression of floating-point data", IEEE TVCG 2006, section 3.2).

The value of a decimal is what a reader of text makes of it: the double next to m * 10^(e - places),
rounded to float32 for float32 files. Where a program computed the values from such numbers, the
column has a conversion (`deltamesh._streams.conversions`) too.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._kernels.coding.exact import FIRST, NEGATIVE_ZERO, RAW
from deltamesh._kernels.coding.grid import BOUND, POWERS
from deltamesh._streams.conversions import (
    DEVIATION_BOUND,
    NO_CONVERSION,
    Conversion,
    conversion_fault,
    converted,
    from_ordinals,
    ordinals,
    unconverted,
)
from deltamesh._streams.decomposition import (
    BINARY_DIGITS,
    DECIMAL_PLACES,
    EXACT,
    NEVER,
    TENS,
    Decomposition,
    decompose,
    length_of,
    rounded_to,
)
from deltamesh_formats.array_types import Bools, Floats, Ints

DECIMAL_DIGITS: Final = 17
# The most places that the grid has beyond those of a decimal format.
DECIMAL_OFFSET: Final = 18
# Of binary64: the exponents of the smallest number and of the unit of the largest.
MAX_PLACES: Final = 1074
MIN_PLACES: Final = -971
# Indices stay below 2^61, so that their differences fit 64 bits.
INDEX_BITS: Final = 61
GRID_BITS: Final = BOUND.bit_length() - 1

# Largest of the usual lengths of distances.
MOST_USUAL: Final = 60

_QUOTIENT: Final = 15  # digits of any numerator: 10^15 < 2^53


@dataclass(frozen=True)
class NumberFormat:
    """Set of the numbers m * base^(e - places); see the module.

    Attributes
    ----------
    base : {2, 10}
    places, digits : int
    """

    base: int
    places: int
    digits: int


@dataclass(frozen=True)
class ColumnFormats:
    """Number formats of the values of a column.

    Attributes
    ----------
    formats : tuple of NumberFormat
        Two at most, of one base. The first that holds a value is that of the value; a value that
        none holds is raw.
    usual : tuple of int
        The usual length of a distance in each format, in bits.
    grid : int
        Predictions are made in integer multiples of base^-grid.
    raw : bool
        Whether there are raw values, which are coded as their bits.
    zeros : bool
        Whether there are negative zeros.
    conversion : Conversion
        What makes values of the numbers; raw values have none.
    """

    formats: tuple[NumberFormat, ...]
    usual: tuple[int, ...]
    grid: int
    raw: bool
    zeros: bool
    conversion: Conversion = NO_CONVERSION


RAW_ONLY: Final = ColumnFormats((), (), 0, raw=True, zeros=False)


def largest_offset(digits: int) -> int:
    """Return the most places that a binary format may have beyond the grid; indices stay small."""
    return (1 << (INDEX_BITS - digits)) - GRID_BITS - 2


def to_indices(values: Floats, column: ColumnFormats, single: bool) -> tuple[Ints, Ints, Ints]:
    """Return the format of each value, its index there, and its deviation.

    Parameters
    ----------
    values : float64 (n,)
    column : ColumnFormats
    single : bool
        Whether all values are float32.

    Returns
    -------
    choices : int64 (n,)
        FIRST, SECOND, RAW or NEGATIVE_ZERO of `deltamesh._kernels.coding.exact`.
    indices : int64 (n,)
        The index of each value in its format, or the bits of a raw one.
    deviations : int64 (n,)
        Zeros, unless the conversion of the column has deviations.
    """
    choices = np.full(len(values), RAW, dtype=np.int64)
    indices, deviations = raw_bits(values, single), np.zeros(len(values), dtype=np.int64)
    if column.formats and not column.conversion.identical:
        parts, off = _sources(values, column, single)
        has = holds(column.formats[0], parts) & (np.abs(off) < DEVIATION_BOUND)
        has &= column.conversion.deviations | (off == 0)
        choices[has], deviations[has] = FIRST, off[has]
        indices[has] = _index(column.formats[0], parts)[has]
        return choices, indices, deviations
    if column.formats:
        parts = decompose(values, column.formats[0].base, single)
        fit = representable(parts)
    for i in reversed(range(len(column.formats))):
        has = fit & holds(column.formats[i], parts)
        choices[has] = i
        indices[has] = _index(column.formats[i], parts)[has]
    if column.zeros:
        negative = np.signbit(values) & (values == 0)
        choices[negative], indices[negative] = NEGATIVE_ZERO, 0
    return choices, indices, deviations


def from_indices(
    choices: Ints, indices: Ints, deviations: Ints, column: ColumnFormats, single: bool
) -> Floats:
    """Return the values: the mirror of `to_indices`; a number beyond its type is infinite."""
    values = np.zeros(len(choices))
    for i, number_format in enumerate(column.formats):
        has = choices == i
        values[has] = _number(number_format, indices[has], single)
    values[choices == NEGATIVE_ZERO] = -0.0
    values = converted(values, column.conversion, single)
    if column.conversion.deviations:
        finite = np.isfinite(values)
        places = ordinals(np.where(finite, values, 0.0), single) + deviations
        values = np.where(finite, from_ordinals(places, single), np.inf)
    values[choices == RAW] = _from_bits(indices[choices == RAW], single)
    return values


def fault_of(column: ColumnFormats, single: bool) -> str:
    """Return the fault of the formats of a column by the rules of SPEC.md 5.12; "" for none."""
    if len(column.formats) > 2 or not (column.formats or column.raw):
        return f"{len(column.formats)} number formats in a column"
    for f, usual in zip(column.formats, column.usual, strict=True):
        offset = column.grid - f.places
        if f.base == 2:
            fits = MIN_PLACES <= f.places <= MAX_PLACES and 1 <= f.digits <= BINARY_DIGITS
            fits = fits and -largest_offset(f.digits) <= offset
        else:
            fits = 0 <= f.places <= DECIMAL_PLACES and 1 <= f.digits <= DECIMAL_DIGITS
            fits = fits and f.base == 10 and 0 <= offset <= DECIMAL_OFFSET
        if not fits or f.base != column.formats[0].base or usual > MOST_USUAL:
            return f"invalid number format: base {f.base}, {f.places} places, {f.digits} digits"
    return conversion_fault(column.conversion, single)


def _sources(values: Floats, column: ColumnFormats, single: bool) -> tuple[Decomposition, Ints]:
    """Return the numbers of which the conversion makes about the values, and the deviations.

    They are multiples of the unit of the first format, with no digits if there is none near.
    """
    f = column.formats[0]
    x = unconverted(values, column.conversion)
    with np.errstate(all="ignore"):
        middle = np.rint(x * TENS[f.places] if f.base == 10 else np.ldexp(x, f.places))
    near = np.abs(middle) < EXACT - 2
    middle = np.where(near, middle, 0.0) + 0.0  # a number that is 0 has no sign
    there = ordinals(values, single)
    best, off = np.zeros_like(middle), np.full(len(values), DEVIATION_BOUND)
    for m in (middle, middle - 1, middle + 1):
        decimal = f.base == 10
        numbers = rounded_to(m / TENS[f.places], single) if decimal else np.ldexp(m, -f.places)
        found = converted(numbers, column.conversion, single)
        finite = near & np.isfinite(found)
        distance = there - ordinals(np.where(finite, found, 0.0), single)
        better = finite & (np.abs(distance) < np.abs(off))
        best, off = np.where(better, m, best), np.where(better, distance, off)
    mantissa = best.astype(np.int64)
    digits = length_of(mantissa, f.base)
    places = np.full(len(values), f.places)
    size = np.where(mantissa == 0, -NEVER, digits - places)
    return Decomposition(f.base, mantissa, places, digits, size), off


def raw_bits(values: Floats, single: bool) -> Ints:
    """Return the bit patterns of values, of binary32 if `single`."""
    if single:
        return values.astype(np.float32).view(np.uint32).astype(np.int64)
    return values.copy().view(np.int64)


def _from_bits(integers: Ints, single: bool) -> Floats:
    if single:
        return (integers & 0xFFFFFFFF).astype(np.uint32).view(np.float32).astype(np.float64)
    return integers.copy().view(np.float64)


def holds(f: NumberFormat, parts: Decomposition) -> Bools:
    """Return which values are numbers of a format, bool (n,)."""
    reach = parts.size + f.places
    near = reach <= (1 << (INDEX_BITS - f.digits)) - 2 if f.base == 2 else reach <= _QUOTIENT
    return np.asarray((parts.places <= f.places) & (parts.digits <= f.digits) & near)


def representable(parts: Decomposition) -> Bools:
    """Return which values may be in a format: those that do not reach too far below the others."""
    largest = int(parts.size.max(initial=-NEVER))
    if parts.base == 2:
        most = GRID_BITS - largest + largest_offset(int(parts.digits.max(initial=1)))
    else:
        most = min(DECIMAL_PLACES, _QUOTIENT - largest)
    digits = BINARY_DIGITS if parts.base == 2 else DECIMAL_DIGITS
    fit = (parts.places <= most) & (parts.digits <= digits)
    return np.asarray(fit | (parts.digits == 0))


def _index(f: NumberFormat, parts: Decomposition) -> Ints:
    """Return the indices of the values that the format holds; of others, anything."""
    unit = np.maximum(-f.places, parts.size - f.digits)  # the power of the base
    e = np.where(parts.mantissa == 0, 0, unit + f.places)
    up = -parts.places - unit
    m = np.abs(parts.mantissa)
    if f.base == 2:
        m = m << np.clip(up, 0, 62)
    else:
        m = m * POWERS[np.clip(up, 0, 18)] // POWERS[np.clip(-up, 0, 18)]
    index = m + e * ((f.base - 1) * f.base ** (f.digits - 1))
    return np.asarray(np.where(parts.mantissa < 0, -index, index))


def _number(f: NumberFormat, index: Ints, single: bool) -> Floats:
    """Return the numbers at these indices."""
    top = f.base ** (f.digits - 1)
    size = np.abs(index)
    e = np.maximum((size - top) // ((f.base - 1) * top), 0)
    m = size - e * ((f.base - 1) * top)
    sign = np.where(index < 0, -1.0, 1.0)
    with np.errstate(over="ignore"):
        if f.base == 2:
            return np.asarray(
                sign * np.ldexp(m.astype(np.float64), np.minimum(e, NEVER) - f.places)
            )
        fits = (e <= 18) & (m < EXACT // POWERS[np.clip(e, 0, 18)])
        exact = np.where(fits, m * POWERS[np.clip(e, 0, 18)], 0).astype(np.float64)
        return sign * np.where(fits, rounded_to(exact / TENS[f.places], single), np.inf)
