"""Normals of the decoded surface at vertices, wedges or polygons, with bounds of their errors.

They predict the normals of a file, which often equal them. Programs give different weights to the
polygons around a vertex (Thürmer, Wüthrich, "Computing vertex normals from polygonal facets", 1998;
Max, "Weights for computing vertex normals from facet normals", 1999), so that three kinds are
tried.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.container.payload_layout import NORMAL_WEIGHTS

# Weights of a polygon: its area, its angle at the element, or one for all.
AREA: Final = NORMAL_WEIGHTS["area"]
ANGLE: Final = NORMAL_WEIGHTS["angle"]
EQUAL: Final = NORMAL_WEIGHTS["equal"]
WEIGHTS: Final = (AREA, ANGLE, EQUAL)

# Least error of positions and products of them, relative to the extent of a mesh.
ROUNDING: Final = 1e-14


@dataclass(frozen=True)
class Surroundings:
    """Polygons of a surface, and the element at each of their corners.

    Elements are vertices; wedges, whose corners share a normal; or polygons.

    Attributes
    ----------
    corners : int64 (c,)
        The vertex at each corner, polygon after polygon.
    offsets : int64 (p + 1,)
        Where the corners of each polygon begin; each has three or more.
    elements : int64 (c,)
        The element at each corner, below `count`.
    count : int
    """

    corners: Ints
    offsets: Ints
    elements: Ints
    count: int


def surface_normals(
    V: Floats, around: Surroundings, weights: int, tolerance: float
) -> tuple[Floats, Floats]:
    """Return the normals of the elements, and bounds of their errors on another machine.

    The normal of an element is the sum over its corners of the area vector of the polygon (EQUAL:
    of length 1; ANGLE: of the length of the angle at the corner), so that polygons across a crease,
    which are at corners of other elements, have no part in it.

    Parameters
    ----------
    V : float64 (n, 3)
    around : Surroundings
    weights : {AREA, ANGLE, EQUAL}
    tolerance : float
        The largest distance of a position that another decoder makes, in the unit of V.

    Returns
    -------
    sums : float64 (count, 3)
        Not normalized; zero where there are no polygons, or none with an area.
    doubt : float64 (count,)
        A bound of the angle by which the direction of the sum may differ, in radians; inf where it
        may be any.
    """
    extent = (float(np.ptp(V, axis=0).max()) if len(V) else 0.0) or 1.0
    small = tolerance / extent + ROUNDING
    starts = around.offsets[:-1]
    of_corner = np.repeat(np.arange(len(starts)), np.diff(around.offsets))
    # Products of coordinates then neither overflow nor vanish, and far from the origin nothing
    # cancels.
    V = (V - V[:1]) / extent
    at = V[around.corners] - V[around.corners[starts]][of_corner]
    following = np.arange(1, len(at) + 1)
    following[around.offsets[1:] - 1] = starts
    previous = np.empty_like(following)
    previous[following] = np.arange(len(at))
    area = _sums(of_corner, np.cross(at, at[following]), len(starts))
    # Moving a corner changes twice the area by that times the diagonal across the corner; moving
    # two, by the product of that as well.
    across = np.linalg.norm(at[following] - at[previous], axis=1)
    error = _gathered(of_corner, small * across + small**2, len(starts))
    if weights != AREA:
        area, error = _unit(area, error)
    vectors, errors = area[of_corner], error[of_corner]
    if weights == ANGLE:
        angle, off = _angles(at[following] - at, at[previous] - at, small)
        vectors, errors = vectors * angle[:, None], errors * angle + off
    sums = _sums(around.elements, vectors, around.count)
    return sums, _angle_bound(sums, _gathered(around.elements, errors, around.count))


def _angle_bound(vectors: Floats, errors: Floats) -> Floats:
    """Return the largest angle by which vectors may differ that have errors of these lengths."""
    length = np.linalg.norm(vectors, axis=1)
    certain = errors < length
    share = np.divide(errors, length, out=np.ones_like(length), where=certain)
    return np.where(certain, np.arcsin(share), np.inf)


def _unit(vectors: Floats, errors: Floats) -> tuple[Floats, Floats]:
    """Return the directions of vectors, zero for zero, and bounds of their errors."""
    length = np.linalg.norm(vectors, axis=1)
    chord = 2 * np.sin(np.minimum(_angle_bound(vectors, errors), np.pi) / 2)
    return vectors / np.where(length > 0, length, 1.0)[:, None], chord


def _angles(a: Floats, b: Floats, small: float) -> tuple[Floats, Floats]:
    """Return the angles between vectors, and bounds of their errors."""
    angle = np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))
    error = np.full(len(a), 2 * small)  # both ends move
    return angle, np.minimum(_angle_bound(a, error) + _angle_bound(b, error), np.pi)


def _sums(groups: Ints, vectors: Floats, count: int) -> Floats:
    return np.stack([_gathered(groups, vectors[:, axis], count) for axis in range(3)], axis=1)


def _gathered(groups: Ints, values: Floats, count: int) -> Floats:
    return np.bincount(groups, values, count).astype(np.float64)
