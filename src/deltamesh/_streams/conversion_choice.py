"""Choice of a conversion for a column, where that takes fewer bits, by an estimate."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

import numpy as np

from deltamesh._kernels.coding.exact import RAW
from deltamesh._streams.conversion_search import Guess, guesses
from deltamesh._streams.format_choice import (
    FORMAT_BITS,
    RAW_BITS,
    Lengths,
    entropy,
    sample_of,
    usual_length,
)
from deltamesh._streams.lattices import Lattice, find_lattice
from deltamesh._streams.number_formats import (
    DECIMAL_DIGITS,
    ColumnFormats,
    NumberFormat,
    fault_of,
    to_indices,
)
from deltamesh_formats.array_types import Bools, Floats

# Bits of two operations, of the flags and of the beginning of another stream.
_CONVERSION_BITS: Final = 240.0
# Values that a search looks at; how often it begins again with those that it got wrong, unless
# these are more than a share of all.
_SOME: Final = 512
_ROUNDS: Final = 3
_FEW: Final = 0.05
# Deviations from the line of a lattice, in the median of all, of values that are surely on it.
_SURELY: Final = 8.0
# An addition may have begun with so many numbers for each value, or with so many at least and most.
_ORIGINS: Final = 3
_FEWEST_ORIGINS, _MOST_ORIGINS = 1 << 15, 1 << 16
# Bits of rounding errors that a sum with a large number may explain.
_EXPLAINED: Final = 12.0
# The least that is saved, as a share of the bits without a conversion.
_LEAST_SAVED: Final = 0.01


def choose_conversion(
    values: Floats, errors: Floats, single: bool, cost: float, plain: ColumnFormats
) -> tuple[float, ColumnFormats]:
    """Choose formats of a column with a conversion, or `plain` ones if these take fewer bits.

    Parameters
    ----------
    values : float64 (n,)
    errors : float64 (k,)
        Errors of predictions.
    single : bool
        Whether all values are float32.
    cost, plain : float, ColumnFormats
        As `choose_formats` returns them.
    """
    lattice = find_lattice(values, single)
    if lattice is None:
        return cost, plain
    sample = sample_of(errors, values)
    length = _length(lattice.step, sample)
    enough = (1 - _LEAST_SAVED) * cost
    deviation = max(float(np.log2(lattice.noise + 1)) - _EXPLAINED, 0.0)
    if (length + deviation) * len(values) + _CONVERSION_BITS > enough:
        return cost, plain
    best: tuple[float, ColumnFormats] = (np.inf, plain)
    sure = _surely(values, lattice)
    near = values[sure]
    # The lowest one is the origin of what was dequantized.
    some = np.append(near[:: max(len(near) // _SOME, 1)], [near.min(), near.max()])
    for _ in range(_ROUNDS):
        column = _best(some, lattice, single, length, len(values))
        if column is None:
            break
        bits, wrong = _bits(values, column, single, length)
        best = min(best, (bits, column), key=lambda one: one[0])
        missed = values[sure & wrong]
        if not len(missed) or len(missed) > _FEW * len(values):
            break
        some = np.concatenate([some, missed[:: max(len(missed) // _SOME, 1)]])
    if best[0] > enough:
        return cost, plain
    return best[0], _trimmed(values, best[1], single)


def _surely(values: Floats, lattice: Lattice) -> Bools:
    """Return which values are on a lattice, up to rounding errors."""
    offsets = values - lattice.origin
    sizes = np.abs(offsets - np.rint(offsets / lattice.step) * lattice.step)
    error = lattice.tolerance * float(np.abs(offsets).max(initial=0.0))
    return np.asarray(sizes <= max(_SURELY * float(np.median(sizes)), error))


def _best(
    some: Floats, lattice: Lattice, single: bool, length: float, count: int
) -> ColumnFormats | None:
    """Return the formats with the guess that takes the fewest bits for some values."""
    best: tuple[float, ColumnFormats | None] = (np.inf, None)
    origins = min(max(_ORIGINS * count, _FEWEST_ORIGINS), _MOST_ORIGINS)
    with np.errstate(all="ignore"):  # numbers near the ends of their type
        for guess in guesses(some, lattice, single, origins):
            column = _with_guess(guess, length)
            if fault_of(column, single):
                continue
            bits, wrong = _bits(some, column, single, length)
            best = min(best, (bits, column), key=lambda one: one[0])
            if not wrong.any():
                break
    return best[1]


def _with_guess(guess: Guess, length: float) -> ColumnFormats:
    places, conversion = guess
    conversion = replace(conversion, deviations=True)
    formats = (NumberFormat(10, places, DECIMAL_DIGITS),)
    return ColumnFormats(formats, (usual_length(length),), places, True, False, conversion)


def _length(step: float, sample: Floats) -> float:
    """Return the mean length of a distance in steps."""
    lengths = Lengths(10, sample / step)
    return float(lengths(NumberFormat(10, 0, DECIMAL_DIGITS), np.zeros(1, dtype=np.int64))[0])


def _bits(
    values: Floats, column: ColumnFormats, single: bool, length: float
) -> tuple[float, Bools]:
    """Return the bits that a column takes, by an estimate, and which values are no results."""
    choices, _, deviations = to_indices(values, column, single)
    raw, sizes = choices == RAW, np.abs(deviations)
    shares = [int(one.sum()) for one in (raw, sizes > 0, ~raw & (sizes == 0))]
    bits = shares[0] * RAW_BITS[single] + (len(values) - shares[0]) * length + entropy(shares)
    bits += float((np.log2(sizes[sizes > 0]) + 1).sum()) + FORMAT_BITS + _CONVERSION_BITS
    return bits, raw | (sizes > 0)


def _trimmed(values: Floats, column: ColumnFormats, single: bool) -> ColumnFormats:
    """Return formats without deviations and raw values where there are none."""
    choices, _, deviations = to_indices(values, column, single)
    conversion = replace(column.conversion, deviations=bool(deviations.any()))
    return replace(column, raw=bool((choices == RAW).any()), conversion=conversion)
