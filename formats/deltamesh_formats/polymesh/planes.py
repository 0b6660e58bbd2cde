"""Polygons in their planes, each from a corner that its positions decide.

Whatever is computed from these coordinates depends neither on the corner at which a file lets a
polygon begin nor on the numbers of its vertices: the arithmetic is the same to the last bit.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats, Ints

# What a product of coordinates up to 2 may be off by, after they were rounded a few times.
TINY: Final = 2.0**-48


def starts(points: Floats, offsets: Ints) -> Ints:
    """Return the corner from which on the positions of each polygon come first in their order.

    Of all its cyclic sequences of positions it begins the lexicographically least; corners that
    begin equal ones are alike. A polygon with a position that is not a number begins at corner 0.

    Parameters
    ----------
    points : float64 (c, 3)
        The position of each corner, polygon after polygon.
    offsets : int64 (p + 1,)

    Returns
    -------
    int64 (p,)
        From 0 up to the size of the polygon less one.
    """
    sizes, first = np.diff(offsets), offsets[:-1]
    polygon = np.repeat(np.arange(len(sizes)), sizes)
    least = np.ones(len(points), dtype=np.bool_)
    for values in points.T:
        lowest = np.minimum.reduceat(np.where(least, values, np.inf), first)
        least &= values == lowest[polygon]
    found = np.flatnonzero(least)
    start = np.zeros(len(sizes), dtype=np.int64)
    start[polygon[found]] = found - first[polygon[found]]
    several = np.bincount(polygon[found], minlength=len(sizes)) > 1
    if several.any():
        some = sizes[several]
        inner = points[several[polygon]]
        start[several] = _least_rotations(inner, np.concatenate(([0], np.cumsum(some))))
    return start


def in_planes(points: Floats, offsets: Ints) -> tuple[Floats, Floats, NDArray[np.bool_]]:
    """Return coordinates x and y, float64 (c,), in which each polygon turns to the left.

    They are an affine image, with a spread of about 1, of the polygon in the plane at right angles
    to its normal (I. Sutherland, R. Sproull, R. Schumacker, *A Characterization of Ten Hidden-
    Surface Algorithms*, 1974, who name M. Newell). Where that is an axis, they are two of the
    polygon's coordinates, not rounded but for the first corner's that is subtracted.

    Parameters
    ----------
    points : float64 (c, 3)
        The position of each corner, polygon after polygon.
    offsets : int64 (p + 1,)

    Returns
    -------
    x, y : float64 (c,)
        Between -2 and 2.
    has_plane : bool (p,)
        False where the normal is zero but for rounding, or not finite; x and y mean nothing then.
    """
    sizes, first = np.diff(offsets), offsets[:-1]
    polygon = np.repeat(np.arange(len(sizes)), sizes)
    after = following(offsets)
    with np.errstate(all="ignore"):  # positions beyond 1e307, or not finite: no plane
        D = np.ascontiguousarray((points - points[first[polygon]]).T)
        spread = np.maximum.reduceat(np.abs(D).max(axis=0), first)
        D = np.ldexp(D, -np.frexp(spread)[1][polygon])
        E = D[:, after]
        turns = (D[1] * E[2] - D[2] * E[1], D[2] * E[0] - D[0] * E[2], D[0] * E[1] - D[1] * E[0])
        normal = np.stack([np.add.reduceat(turn, first) for turn in turns])
        w = np.argmax(np.abs(normal), axis=0)
        height = np.take_along_axis(normal, w[None], axis=0)[0]
        has_plane = np.isfinite(normal).all(axis=0) & (np.abs(height) > TINY)
        # One steps along the normal until the coordinate w is 0.
        w = np.where(height < 0, w + 3, w)
        along = [((w + 1) % 3), ((w + 2) % 3)]
        u, v = (np.where(w < 3, *pair) for pair in (along, along[::-1]))
        x, y = (_sheared(D, normal / height, axis, w % 3, polygon) for axis in (u, v))
    return x, y, has_plane


def following(offsets: Ints) -> Ints:
    """Return the corner after each, in the same polygon, int64 (c,)."""
    after = np.arange(1, offsets[-1] + 1)
    after[offsets[1:] - 1] = offsets[:-1]
    return after


def _sheared(D: Floats, slopes: Floats, axis: Ints, w: Ints, polygon: Ints) -> Floats:
    slope = np.take_along_axis(slopes, axis[None], axis=0)[0]
    every = np.arange(len(polygon))
    sheared: Floats = D[axis[polygon], every] - slope[polygon] * D[w[polygon], every]
    return sheared


def _least_rotations(points: Floats, offsets: Ints) -> Ints:
    """Return the corner that begins the lexicographically least cyclic sequence of each polygon.

    Sequences of 1, 2, 4, ... corners are ranked one after the other, those of twice the length by
    the ranks of their halves (R. Karp, R. Miller, A. Rosenberg, *Rapid identification of repeated
    patterns*, 1972).
    """
    sizes, first = np.diff(offsets), offsets[:-1]
    base, size = np.repeat(first, sizes), np.repeat(sizes, sizes)
    place = np.arange(len(points)) - base
    order = np.lexsort(points.T[::-1])
    new = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    rank = np.empty(len(points), dtype=np.int64)
    rank[order] = np.concatenate(([0], np.cumsum(new)))
    length = 1
    while length < sizes.max():
        pair = rank * len(points) + rank[base + (place + length) % size]
        rank = np.unique(pair, return_inverse=True)[1]
        length *= 2
    lowest = np.flatnonzero(rank == np.repeat(np.minimum.reduceat(rank, first), sizes))
    start = np.empty(len(sizes), dtype=np.int64)
    start[np.repeat(np.arange(len(sizes)), sizes)[lowest]] = place[lowest]
    return start
