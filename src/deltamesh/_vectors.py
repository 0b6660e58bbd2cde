"""Vectors in rows: their lengths, cross products and angles, and the box around them."""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Floats, Ints

# Powers of two whose squares, and sums of these, are far from the ends of double precision.
SAFE_EXPONENT: Final = 460


def lengths(a: Floats) -> Floats:
    """Return the lengths of vectors (k, 3)."""
    return np.sqrt(dots(a, a))


def safe_lengths(a: Floats) -> Floats:
    """Return the lengths of vectors (k, 3) of any scale; squares neither overflow nor vanish."""
    exponent = math.frexp(largest(a))[1]
    if abs(exponent) < SAFE_EXPONENT:
        return lengths(a)
    return np.ldexp(lengths(np.ldexp(a, -exponent)), exponent)


def dots(a: Floats, b: Floats) -> Floats:
    """Return the scalar products of vectors (k, 3)."""
    return np.asarray(a[:, 0] * b[:, 0] + a[:, 1] * b[:, 1] + a[:, 2] * b[:, 2])


def crosses(a: Floats, b: Floats) -> Floats:
    """Return the cross products of vectors (k, 3); `np.cross` takes three times as long."""
    x = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    y = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    z = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return np.stack((x, y, z), axis=1)


def angles(a: Floats, b: Floats) -> Floats:
    """Return the angles between vectors (k, 3) of any length in degrees, 0 for zero vectors."""
    return np.degrees(np.arctan2(lengths(crosses(a, b)), dots(a, b)))


def largest(x: Floats | Ints) -> float:
    """Return the largest magnitude of numbers, 0 without any, and NaN if one of them is."""
    return max(float(x.max(initial=0)), -float(x.min(initial=0)))


def sides(V: Floats) -> Floats:
    """Return the sides of the bounding box of points (n, c), float64 (c,); 0 without any."""
    # By columns: along the first axis of narrow rows, `np.ptp` takes twenty times as long.
    return np.array([np.ptp(column) if len(column) else 0.0 for column in V.T])
