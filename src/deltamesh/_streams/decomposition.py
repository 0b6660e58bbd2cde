"""Decomposition of numbers into a mantissa and a power of two or ten."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._kernels.coding.grid import POWERS
from deltamesh_formats.array_types import Floats, Ints

# Decimals are quotients of two exact doubles, rounded once: m * 10^e < 2^53, and 10^22.
EXACT: Final = 1 << 53
DECIMAL_PLACES: Final = 22
TENS: Final = np.array([float(f"1e{k}") for k in range(DECIMAL_PLACES + 1)])
BINARY_DIGITS: Final = 53
# Places and digits of a number that is no decimal; its negative is below the size of any number.
NEVER: Final = 1 << 12


@dataclass(frozen=True)
class Decomposition:
    """Shortest mantissa and exponent of each value in a base.

    Attributes
    ----------
    base : int
    mantissa, places : int64 (n,)
        The value is mantissa * base^-places.
    digits : int64 (n,)
        Digits of the mantissa.
    size : int64 (n,)
        Digits before the point, or less the zeros after it.
    """

    base: int
    mantissa: Ints
    places: Ints
    digits: Ints
    size: Ints


def decompose(values: Floats, base: int, single: bool) -> Decomposition:
    """Return the shortest mantissa and exponent of each value.

    Parameters
    ----------
    values : float64 (n,)
    base : {2, 10}
    single : bool
        Whether decimals are rounded to float32.
    """
    return _binary(values) if base == 2 else _decimal(values, single)


def _binary(values: Floats) -> Decomposition:
    mantissa, exponent = np.frexp(values)
    size = exponent.astype(np.int64)
    m = np.ldexp(mantissa, BINARY_DIGITS).astype(np.int64)
    lowest = (m & -m).astype(np.float64)
    spare = np.where(m == 0, BINARY_DIGITS, np.frexp(lowest)[1].astype(np.int64) - 1)
    places = np.where(m == 0, -NEVER, BINARY_DIGITS - size - spare)
    return Decomposition(
        2, m >> spare, places, BINARY_DIGITS - spare, np.where(m == 0, -NEVER, size)
    )


def _decimal(values: Floats, single: bool) -> Decomposition:
    """Return the shortest decimal of each value."""
    mantissa = np.zeros(len(values), dtype=np.int64)
    places = np.full(len(values), NEVER, dtype=np.int64)
    left = np.flatnonzero(np.abs(values) < EXACT)
    for k in range(DECIMAL_PLACES + 1):
        x = values[left]
        rounded = np.rint(x * TENS[k])
        small = np.abs(rounded) < EXACT
        same = small & (rounded_to(rounded / TENS[k], single) == x)
        found = left[same]
        mantissa[found], places[found] = rounded[same].astype(np.int64), k
        left = left[small & ~same]
        if not len(left):
            break
    size = np.abs(mantissa)
    length = length_of(mantissa, 10)
    # Of whole numbers, the zeros at the end are no digits.
    zeros = np.zeros(len(values), dtype=np.int64)
    for power in POWERS[1:16]:
        zeros += size % power == 0
    before = np.where(size == 0, -NEVER, length - places)
    digits = np.where(places == NEVER, NEVER, np.where(size == 0, 0, length - zeros))
    return Decomposition(10, mantissa, places, digits, before)


def length_of(mantissa: Ints, base: int) -> Ints:
    """Return the number of digits of integers below 2^53, 0 of 0."""
    if base == 2:
        return np.frexp(mantissa.astype(np.float64))[1].astype(np.int64)
    return np.searchsorted(POWERS, np.abs(mantissa), side="right")


def rounded_to(x: Floats, single: bool) -> Floats:
    """Return values rounded to float32 if `single`."""
    return x.astype(np.float32).astype(np.float64) if single else x
