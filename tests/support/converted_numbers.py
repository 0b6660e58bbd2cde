"""Columns that programs compute from decimals or from integers, of each kind that is found."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Column = NDArray[np.float64]


def as_single(x: Column | float) -> Column:
    return np.asarray(x, dtype=np.float32).astype(np.float64)


def walk(count: int, seed: int) -> Column:
    """Numbers of which each is near the one before, as those of neighbours are."""
    rng = np.random.default_rng(seed)
    return np.cumsum(rng.normal(size=count)) / 2 + rng.normal(size=count)


def _grid(x: Column, bits: int) -> Column:
    return np.rint((x - x.min()) / np.ptp(x) * (2**bits - 1))


def dequantized(x: Column, bits: int, single: bool) -> Column:
    k, step = _grid(x, bits), 37.1 / (2**bits - 1)
    if single:
        return as_single(as_single(k * as_single(step)) + as_single(-3.77))
    return k * step - 3.77


# Of each kind: whether values are float32, and how they are made of decimals of three places, in
# their own type.
KINDS: dict[str, tuple[bool, Callable[[Column], Column]]] = {
    "centred": (True, lambda d: as_single(d - as_single(d.mean()))),
    "centred by a decimal": (True, lambda d: as_single(d - as_single(12.748))),
    "times 0.001": (True, lambda d: as_single(d * as_single(0.001))),
    "times 25.4": (True, lambda d: as_single(d * as_single(25.4))),
    "times 0.3048 in float64": (True, lambda d: as_single(d * 0.3048)),
    "divided by 1000": (True, lambda d: as_single(d / 1000)),
    "centred float64": (False, lambda d: d - d.mean()),
    "times 0.0254 float64": (False, lambda d: d * 0.0254),
    "divided by 1000 float64": (False, lambda d: d / 1000),
    "10 bits": (True, lambda d: dequantized(d, 10, single=True)),
    "16 bits": (True, lambda d: dequantized(d, 16, single=True)),
    "12 bits in float64": (True, lambda d: as_single(dequantized(d, 12, single=False))),
    "14 bits float64": (False, lambda d: dequantized(d, 14, single=False)),
}


def made(kind: str, count: int, seed: int = 0) -> tuple[bool, Column]:
    """Return whether values of a kind are float32, and these."""
    single, function = KINDS[kind]
    decimals = walk(count, seed).round(3)
    return single, function(as_single(decimals) if single else decimals)
