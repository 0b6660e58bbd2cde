"""Unit normals as pairs of small integers, relative to the normals of the decoded surface.

A direction becomes a point of a square grid by way of an octahedron (Meyer, Suessmuth, Sussner,
Stamminger, Greiner, "On Floating-Point Normal Vectors", 2010; Cigolle, Donow, Evangelakos, Mara,
McGuire, Meyer, "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 2014).
The octahedron stands in a frame that follows the prediction: grid point (0, 0) is the prediction
itself, so that the errors of the decoder's arithmetic move a normal as much as the surface below
it, and no more. No decision depends on them.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.payload_layout import NORMAL_STATES

# States of a normal: relative to the prediction; by itself; the vector (0, 0, 0).
RELATIVE: Final = NORMAL_STATES["relative"]
ABSOLUTE: Final = NORMAL_STATES["absolute"]
ZERO: Final = NORMAL_STATES["zero"]

# The columns are orthonormal, the determinant is 1, and the entries are exact but for the division.
# A half-turn takes its last column to the prediction. It is singular for the opposite one, which no
# symmetry, and no tool that draws at right angles, makes likely.
FRAME: Final = np.array([[6.0, -3, 2], [2, 6, 3], [-3, -2, 6]]) / 7
POLE: Final = FRAME[:, 2]

# A normal that the decoder's arithmetic may move by more than that share of a step of the grid is
# coded by itself.
LARGEST_DOUBT: Final = 1 / 8

# Largest difference of a length from 1.
UNIT_TOLERANCE: Final = 1e-3


def half(bits: int) -> int:
    """Return the largest coordinate: the grid has 2^bits - 1 points a side, one in the middle."""
    return (1 << (bits - 1)) - 1


def is_unit(values: NDArray[np.generic]) -> bool:
    """Return whether these are normals: (k, 3) floats of length 1 within 1e-3, or zero."""
    if values.ndim != 2 or values.shape[1] != 3 or values.dtype.kind != "f":
        return False
    v = values.astype(np.float64)
    with np.errstate(over="ignore", invalid="ignore"):
        length = np.sqrt((v * v).sum(axis=1))
        unit = np.abs(length - 1) <= UNIT_TOLERANCE  # not for NaN
    return bool((unit | (v == 0).all(axis=1)).all())


def to_octahedral(directions: Floats, bits: int) -> Ints:
    """Return the nearest grid points, int64 (k, 2), of unit vectors, float64 (k, 3)."""
    h = half(bits)
    x = directions[:, :2] * (h / np.abs(directions).sum(axis=1))[:, None]
    folded = (h - np.abs(x[:, ::-1])) * _signs(x)
    low = np.floor(np.where(directions[:, 2:] < 0, folded, x)).astype(np.int64)
    # The corner of the cell that is nearest on the square need not be so on the sphere.
    best: Ints = low
    least = np.full(len(x), np.inf)
    for corner in ((0, 0), (1, 0), (0, 1), (1, 1)):
        point = np.clip(low + np.array(corner), -h, h)
        error = ((from_octahedral(point, bits) - directions) ** 2).sum(axis=1)
        best = np.where((error < least)[:, None], point, best)
        least = np.minimum(error, least)
    return best


def from_octahedral(points: Ints, bits: int) -> Floats:
    """Return the unit vectors, float64 (k, 3), of grid points, int64 (k, 2)."""
    h = half(bits)
    z = h - np.abs(points).sum(axis=1, keepdims=True)
    folded = (h - np.abs(points[:, ::-1])) * _signs(points)
    x = np.where(z < 0, folded, points)
    return _normalized(np.concatenate((x, z), axis=1).astype(np.float64))


def quantize_normals(normals: Floats, predicted: Floats, doubt: Floats, bits: int) -> Ints:
    """Return the codes of normals; the mirror is `restore_normals`.

    Parameters
    ----------
    normals : float64 (k, 3)
        Finite; of any length, zero included.
    predicted, doubt : float64 (k, 3), (k,)
        From `surface.surface_normals`.
    bits : int
        Of a coordinate, MIN_NORMAL_BITS to MAX_NORMAL_BITS.

    Returns
    -------
    int64 (k, 3)
        State, and a grid point.
    """
    directions, p = _normalized(normals), _predictions(predicted)
    zero = ~directions.any(axis=1)
    # A half-turn moves 2 / |p + POLE| times as far as its axis.
    moved = 2 * doubt / np.maximum(np.linalg.norm(p + POLE, axis=1), 1e-300)
    state = np.where(moved <= LARGEST_DOUBT / half(bits), RELATIVE, ABSOLUTE)
    state[zero] = ZERO
    relative = (state == RELATIVE)[:, None]
    directions[zero] = POLE
    grid = to_octahedral(np.where(relative, _turned(directions, p) @ FRAME, directions), bits)
    grid[zero] = 0
    return np.concatenate((state[:, None], grid), axis=1)


def restore_normals(codes: Ints, predicted: Floats, bits: int) -> Floats:
    """Return unit normals, float64 (k, 3), or zeros, whatever the codes and predictions are."""
    h, state = half(bits), codes[:, 0]
    grid = from_octahedral(np.clip(codes[:, 1:], -h, h), bits)
    turned = _turned(grid @ FRAME.T, _predictions(predicted))
    normals = _normalized(np.where((state == RELATIVE)[:, None], turned, grid))
    normals[state == ZERO] = 0.0
    return normals


def _predictions(sums: Floats) -> Floats:
    """Return the directions of sums, POLE for those without one."""
    p = _normalized(sums)
    p[~p.any(axis=1)] = POLE
    return p


def _turned(v: Floats, p: Floats) -> Floats:
    """Turn vectors about the bisector of POLE and p by 180 degrees: an involution, POLE to p."""
    axis = _normalized(p + POLE)
    along: Floats = (axis * v).sum(axis=1, keepdims=True)
    return 2 * along * axis - v


def _normalized(v: Floats) -> Floats:
    """Return the directions of vectors, zero for those that are zero or not finite."""
    finite: Floats = np.where(np.isfinite(v).all(axis=1, keepdims=True), v, 0.0)
    largest = np.abs(finite).max(axis=1)
    # Scaled, so that no square overflows or vanishes.
    scaled = finite / np.where(largest > 0, largest, 1.0)[:, None]
    length = np.sqrt((scaled * scaled).sum(axis=1))
    return np.asarray(scaled / np.where(length > 0, length, 1.0)[:, None], dtype=np.float64)


def _signs(x: Ints | Floats) -> Ints:
    """Return -1 for negative numbers, 1 for others."""
    return np.asarray(1 - 2 * (x < 0), dtype=np.int64)
