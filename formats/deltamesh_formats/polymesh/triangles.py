"""Polygons cut into triangles, always in the same way."""

from __future__ import annotations

from typing import Final, NamedTuple

import numpy as np

from deltamesh_formats.array_types import Bools, Floats, Ints

# Each corner is tried as the middle of the fan, which is quadratic in the size of the polygon.
_LARGEST_TRIED: Final = 16


class Triangles(NamedTuple):
    """The triangles of a mesh of polygons, those of a polygon one after the other.

    Attributes
    ----------
    faces : int64 (t, 3)
        Vertex indices.
    polygon : int64 (t,)
        The polygon that each is cut from.
    corners : int64 (t, 3)
        Indices of the polygons' corners, for attributes of corners.
    """

    faces: Ints
    polygon: Ints
    corners: Ints


def triangulate(vertices: Floats, corners: Ints, offsets: Ints) -> Triangles:
    """Cut each polygon into a fan of triangles (a, i, i + 1) around one of its corners a.

    That is its first corner, so that regular meshes are cut regularly, unless a triangle of that
    fan is turned against the polygon or has no area, as at a reflex corner. Then it is the corner
    whose fan has the best worst triangle: the largest least product of a triangle's normal with
    the polygon's. Polygons of more than 16 corners always take the first.

    Parameters
    ----------
    vertices : float64 (n, 3)
    corners : int64 (c,)
    offsets : int64 (p + 1,)
        Polygons of at least three corners.
    """
    sizes = np.diff(offsets)
    if not len(sizes) or (sizes == 3).all():
        at = np.arange(len(corners), dtype=np.int64).reshape(-1, 3)
        return Triangles(corners.reshape(-1, 3), np.arange(len(sizes), dtype=np.int64), at)
    return fans(corners, offsets, middles(vertices, corners, offsets))


def fans(corners: Ints, offsets: Ints, around: Ints) -> Triangles:
    """Cut each polygon into a fan around a corner of it.

    Parameters
    ----------
    corners : int64 (c,)
    offsets : int64 (p + 1,)
    around : int64 (p,)
        From 0 up to the size of the polygon less one.
    """
    sizes, first = np.diff(offsets), offsets[:-1]
    polygon = np.repeat(np.arange(len(sizes), dtype=np.int64), sizes - 2)
    begin = np.cumsum(sizes - 2) - (sizes - 2)
    second = around[polygon] + 1 + np.arange(len(polygon)) - begin[polygon]
    cut = np.stack([around[polygon], second, second + 1], axis=1)
    cut = first[polygon, None] + cut % sizes[polygon, None]
    return Triangles(corners[cut], polygon, cut)


def middles(vertices: Floats, corners: Ints, offsets: Ints) -> Ints:
    """Return the corner around which `triangulate` cuts each polygon, int64 (p,)."""
    sizes = np.diff(offsets)
    around = np.zeros(len(sizes), dtype=np.int64)
    for size in np.unique(sizes).tolist():
        if 3 < size <= _LARGEST_TRIED:
            chosen = np.flatnonzero(sizes == size)
            at = offsets[chosen, None] + np.arange(size)
            around[chosen] = _middles(vertices[corners[at]])
    return around


def folds(points: Floats, corner: int) -> Bools:
    """Tell which polygons of one size, (q, size, 3), the fan around a corner folds, bool (q,)."""
    with np.errstate(all="ignore"):
        return ~(_worst(np.roll(points, -corner, axis=1)) > 0)


def _middles(points: Floats) -> Ints:
    """Return the corner, int64 (q,), around which to cut polygons of one size, (q, size, 3)."""
    middles = np.zeros(len(points), dtype=np.int64)
    with np.errstate(all="ignore"):  # coordinates beyond 1e75 may overflow: the first, then
        worst = _worst(points)
        folded = np.flatnonzero(~(worst > 0))
        best = worst[folded]
        for corner in range(1, points.shape[1]):
            score = _worst(np.roll(points[folded], -corner, axis=1))
            better = score > best
            middles[folded[better]] = corner
            best[better] = score[better]
    return middles


def _worst(points: Floats) -> Floats:
    """Return the least product of a normal of the fan around corner 0 with the polygon's."""
    spokes = points[:, 1:] - points[:, :1]
    normals = np.cross(spokes[:, :-1], spokes[:, 1:])
    whole = normals.sum(axis=1)  # Newell's normal, whichever the middle
    products: Floats = np.einsum("qtk,qk->qt", normals, whole).min(axis=1)
    return products
