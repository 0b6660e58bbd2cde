"""Margins: how far a writer may round the numbers of a decoded mesh.

A margin is a small share of the error that a file has, so that what is written keeps the bounds
that the encoder was given, and has no digits that mean nothing.
"""

from __future__ import annotations

import math
from typing import Final

import numpy as np

from deltamesh._measures.metrics import VertexErrors
from deltamesh._vectors import crosses, lengths
from deltamesh_formats.array_types import Floats, Ints

# Of a distance, or of half a step: what rounding may add to it. Encoders leave as much.
SHARE: Final = 1 / 200
# Of an angle: rounding adds the square root of the sum of squares, which is a SHARE at most.
ANGLE_SHARE: Final = 1 / 20
# Angles below this, in degrees, are not seen, whatever the error of a file is.
LEAST_ANGLE: Final = 0.02
# In diagonals of the bounding box: the positions of two decoders differ by ten times that.
LEAST: Final = 1e-10


def position_margin(errors: VertexErrors, diagonal: float, V: Floats, F: Ints) -> float:
    """Return the margin of each coordinate of decoded positions.

    Each coordinate rounded by a margin moves a vertex by at most `SHARE` of the RMS distance. It
    turns the faces, on average, by at most `ANGLE_SHARE` of the angle errors: uniform errors of at
    most r turn a triangle of area A and sides a, b, c by about r sqrt(a^2 + b^2 + c^2) / (2
    sqrt(3) A), the gradient of the linear function with these values at the corners.

    Parameters
    ----------
    errors : VertexErrors
        Of the decoded mesh.
    diagonal : float
        Of the bounding box.
    V : float64 (n, 3)
        Decoded positions.
    F : int64 (m, 3)
    """
    distance = SHARE * errors.rms / math.sqrt(3)
    angle = min((a for a in (errors.normal_deviation, errors.dihedral) if a > 0), default=0.0)
    allowed = ANGLE_SHARE * math.radians(max(angle, LEAST_ANGLE))
    return max(min(distance, allowed * _height(V, F, diagonal)), LEAST * diagonal)


def _height(V: Floats, F: Ints, diagonal: float) -> float:
    """Return the margin that turns the faces by about one radian, infinite without any area."""
    unit = diagonal or 1.0
    a, b, c = (V[F[:, i]] / unit for i in range(3))
    left, right, third = b - a, c - a, c - b
    area = lengths(crosses(left, right)).sum() / 2
    sides = np.sqrt(sum(lengths(side) ** 2 for side in (left, right, third))).sum()
    return float(2 * math.sqrt(3) * area / sides) * unit if area > 0 else math.inf


def worst(one: VertexErrors, other: VertexErrors) -> VertexErrors:
    """Return the larger of each error."""
    return VertexErrors(**{name: max(x, vars(other)[name]) for name, x in vars(one).items()})
