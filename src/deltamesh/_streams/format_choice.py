"""Choice of the number formats that code a column in the fewest bits, by an estimate."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from deltamesh._streams.decomposition import BINARY_DIGITS, NEVER, Decomposition, decompose
from deltamesh._streams.number_formats import (
    DECIMAL_OFFSET,
    GRID_BITS,
    MOST_USUAL,
    RAW_ONLY,
    ColumnFormats,
    NumberFormat,
    holds,
    representable,
)
from deltamesh_formats.array_types import Floats, Ints

_Formats = tuple[NumberFormat, ...]

SINGLE_DIGITS: Final = 24
# A usual length below this one is 0: the coder then asks for the length of a distance from 0 up.
LEAST_USUAL: Final = 3.5

# Bits that a format itself takes.
FORMAT_BITS: Final = 40.0
# Bits of a raw value, of float64 and of float32.
RAW_BITS: Final = (65.0, 33.0)
# Limits: of the values that choose the base, of the errors, of the lattices of base 2.
_SOME: Final = 1 << 14
_ERRORS: Final = 32
_MOST_LATTICES: Final = 64


def choose_formats(values: Floats, errors: Floats, single: bool) -> tuple[float, ColumnFormats]:
    """Choose the formats of a column that take the fewest bits, by an estimate; return both.

    Parameters
    ----------
    values : float64 (n,)
    errors : float64 (k,)
        Errors of predictions.
    single : bool
        Whether all values are float32.
    """
    zeros = bool((np.signbit(values) & (values == 0)).any())
    raw_bits = RAW_BITS[single]
    sample = sample_of(errors, values)
    # The base is that of the best formats of some values; its best formats of all are then taken.
    some = values[:: len(values) // _SOME + 1]
    costs = {b: _best(decompose(some, b, single), sample, raw_bits)[0] for b in (2, 10)}
    base = min(costs, key=costs.__getitem__)
    parts = decompose(values, base, single)
    cost, formats = _best(parts, sample, raw_bits)
    if cost > raw_bits * len(values):
        return raw_bits * len(values), RAW_ONLY
    return cost, _column_formats(parts, formats, sample, zeros)


def sample_of(errors: Floats, values: Floats) -> Floats:
    """Return quantiles of the errors of predictions, or, without any, of the sizes of values."""
    sizes = errors if len(errors) else np.abs(values)
    return np.asarray(
        np.quantile(sizes[:: len(sizes) // _SOME + 1], (np.arange(_ERRORS) + 0.5) / _ERRORS)
    )


def _best(parts: Decomposition, errors: Floats, raw_bits: float) -> tuple[float, _Formats]:
    """Return the fewest bits that formats of the base take, and these formats."""
    distinct, counts = _distinct(parts)
    fit = representable(distinct)
    lengths = Lengths(parts.base, errors)
    best: tuple[float, _Formats] = (np.inf, ())
    for f in _first_formats(parts.base, distinct.places[fit], distinct.digits[fit]):
        first = fit & holds(f, distinct)
        rest = fit & ~first
        formats: _Formats = (f,)
        shares = [int(counts[first].sum()), int(counts[~fit].sum())]
        cost = counts[first] @ lengths(f, distinct.size[first]) + shares[1] * raw_bits
        if rest.any():
            places, digits = int(distinct.places[rest].max()), int(distinct.digits[rest].max())
            second = NumberFormat(parts.base, places, digits)
            formats = (f, second)
            shares.append(int(counts[rest].sum()))
            cost += counts[rest] @ lengths(second, distinct.size[rest])
        cost += FORMAT_BITS * len(formats) + entropy(shares)
        best = min(best, (float(cost), formats), key=lambda one: one[0])
    return best


def _distinct(parts: Decomposition) -> tuple[Decomposition, Ints]:
    """Return the distinct decompositions but those of zeros, and how many values have each."""
    span = 2 * NEVER + 1
    keys = ((parts.places + NEVER) * span + parts.digits) * span + parts.size + NEVER
    keys, counts = np.unique(keys[parts.digits > 0], return_counts=True)
    places, digits, size = keys // span**2 - NEVER, keys // span % span, keys % span - NEVER
    return Decomposition(parts.base, np.ones_like(keys), places, digits, size), counts


def _first_formats(base: int, places: Ints, digits: Ints) -> Iterator[NumberFormat]:
    """Yield the candidates for the first format, by the places and digits of the values."""
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
            yield NumberFormat(base, int(k), int(p))


class Lengths:
    """Estimate of the bits of a distance: the mean of log2(1 + error / unit) over a sample."""

    def __init__(self, base: int, errors: Floats) -> None:
        self.base = float(np.log2(base))
        with np.errstate(divide="ignore"):
            self.errors = np.log2(errors)

    def __call__(self, f: NumberFormat, size: Ints) -> Floats:
        """Return the estimates for values of these sizes."""
        units = np.maximum(-f.places, size - f.digits) * self.base
        return np.asarray(np.logaddexp2(0.0, self.errors - units[:, None]).mean(axis=1))


def usual_length(mean: float) -> int:
    """Return the length of a distance that the coder asks for first, by the mean of lengths."""
    return min(round(float(mean)), MOST_USUAL) if mean >= LEAST_USUAL else 0


def entropy(shares: list[int]) -> float:
    """Return the bits of the choices of as many values of each kind."""
    total = sum(shares)
    return sum(s * float(np.log2(total / s)) for s in shares if s)


def _column_formats(
    parts: Decomposition, formats: _Formats, errors: Floats, zeros: bool
) -> ColumnFormats:
    """Return the formats with the usual lengths of distances, and the grid of predictions."""
    grid = max(f.places for f in formats)
    if parts.base == 2:
        grid = min(grid, GRID_BITS - int(parts.size.max(initial=-NEVER)))
    usual, left = [], representable(parts)
    raw = bool((~left).any())
    lengths = Lengths(parts.base, errors)
    for f in formats:
        has = left & holds(f, parts)
        left &= ~has
        sizes, counts = np.unique(parts.size[has & (parts.digits > 0)], return_counts=True)
        mean = counts @ lengths(f, sizes) / counts.sum() if len(sizes) else 0.0
        usual.append(usual_length(mean))
    return ColumnFormats(formats, tuple(usual), grid, raw, zeros)
