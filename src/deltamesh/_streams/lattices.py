"""Lattice that most values of a column are near: multiples of a step, from an origin.

The step divides the differences of values, up to rounding errors. Fractions of a small difference
are tried, by the phases of other small differences (as in a periodogram). Straight lines fitted to
values ever farther from one of them, each time as far as the multiples are certain, then make the
step as exact as the values are.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Bools, Floats, Ints

# Values that are looked at, and the fewest distinct ones that a lattice is seen in.
MOST_VALUES: Final = 1 << 14
_FEWEST: Final = 24
# A step of fewer units in the last place saves too little.
_LEAST_STEP: Final = 16
# Small differences that are tried, by their ranks; the fractions of each; and how many others, up
# to that many times as large, have to agree, by the mean of the cosines of their phases.
_RANKS: Final = (0.02, 0.1, 0.25, 0.5, 0.75)
_FRACTIONS: Final = np.arange(1.0, 257.0)
_OTHERS: Final = 128
_TIMES_AS_LARGE: Final = 4.0
_AGREEMENT: Final = 0.75
# Rounding errors of values on the lattice, in steps, and the least share of such values.
_NEAR: Final = 0.2
_SHARE: Final = 0.7
# Relative error of what is computed here.
_DOUBLE: Final = 2.0**-49


@dataclass(frozen=True)
class Lattice:
    """Numbers origin + k * step for integers k.

    Attributes
    ----------
    step, origin : float
        The origin is one of the values, nearly.
    tolerance : float
        Relative error of the step.
    noise : float
        Median distance of a value, in units in the last place of the largest.
    """

    step: float
    origin: float
    tolerance: float
    noise: float

    def multiples(self, values: Floats) -> tuple[Ints, Bools]:
        """Return the nearest multiples, int64 (n,), and which values are near them."""
        x = (values - self.origin) / self.step
        k = np.rint(x)
        return k.astype(np.int64), np.abs(x - k) < _NEAR


def units(values: Floats, single: bool) -> Floats:
    """Return the units in the last place of values."""
    if single:
        return np.spacing(np.abs(values).astype(np.float32)).astype(np.float64)
    return np.asarray(np.spacing(np.abs(values)))


def find_lattice(values: Floats, single: bool) -> Lattice | None:
    """Return the lattice of the largest step that most values are near, if there is one.

    Parameters
    ----------
    values : float64 (n,)
    single : bool
        Whether all values are float32.
    """
    distinct = np.unique(values[:: len(values) // MOST_VALUES + 1])
    if len(distinct) < _FEWEST:
        return None
    unit = float(units(np.abs(distinct[[0, -1]]).max(keepdims=True), single)[0])
    differences = np.sort(np.diff(distinct))
    differences = differences[differences > _LEAST_STEP * unit / 2]
    if len(differences) < _FEWEST // 2:
        return None
    for rank in _RANKS:
        difference = float(differences[int(rank * len(differences))])
        step = _step(differences, difference, unit)
        lattice = _refined(distinct, step, difference, unit) if step else None
        if lattice:
            return lattice
    return None


def _step(differences: Floats, difference: float, unit: float) -> float:
    """Return the largest fraction of a difference that divides others too; 0 for none."""
    some = differences[: np.searchsorted(differences, _TIMES_AS_LARGE * difference)]
    some = some[:: len(some) // _OTHERS + 1]
    steps = difference / _FRACTIONS
    steps = steps[steps >= _LEAST_STEP * unit]
    agreement = np.cos(2 * np.pi * (some / steps[:, None])).mean(axis=1)
    good = np.flatnonzero(agreement > _AGREEMENT)
    return float(steps[good[0]]) if len(good) else 0.0


def _refined(distinct: Floats, step: float, reach: float, unit: float) -> Lattice | None:
    """Return the lattice that lines fitted to values lead to, if most are near it."""
    middle = distinct[len(distinct) // 2]
    offsets = distinct - middle
    distances = np.abs(offsets)
    slack = _NEAR * step / unit
    origin = 0.0
    first = True
    while first or reach < distances.max():
        reach = reach * slack
        x = offsets[distances <= reach]
        if first:
            phases = np.exp(2j * np.pi * (x / step)).mean()
            origin, first = float(np.angle(phases)) / (2 * np.pi) * step, False
        k = np.rint((x - origin) / step)
        near = np.abs(x - origin - k * step) < _NEAR * step
        if near.mean() < _SHARE:
            return None
        m, y = k[near] - k[near].mean(), x[near]
        if m.any():
            step = float(m @ (y - y.mean()) / (m @ m))
            origin = float((y - k[near] * step).mean())
    errors = np.abs(offsets - origin - np.rint((offsets - origin) / step) * step)
    tolerance = 4 * unit / float(np.ptp(distinct)) + _DOUBLE
    return Lattice(step, float(middle + origin), tolerance, float(np.median(errors)) / unit)
