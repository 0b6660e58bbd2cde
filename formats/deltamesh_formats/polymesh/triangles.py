"""Polygons cut into triangles that do not fold, by where their corners are alone.

The same polygon is cut at the same diagonals wherever it begins and however its vertices are
numbered: a mesh that has lost both, as in a `.dmesh` file, still has the same triangles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.polymesh.ears import FLAT, clip_ears
from deltamesh_formats.polymesh.planes import following, in_planes, starts

# Diagonals that differ by less, as part of their squares, are equally long; half of quads by less
# than this part of the whole has no area.
_ALIKE: Final = 1e-3
_SLIVER: Final = 1e-6
# Along this direction, which no grid is likely to have, equally long diagonals are told apart.
_SLANT: Final = (1.0, 0.71, 0.37)
# Ears take a time that grows with the square of the size: half a minute or so at this one.
_LARGEST: Final = 1 << 16
_AT_A_TIME: Final = 1 << 14  # quads: few enough for the caches of a processor


@dataclass(frozen=True)
class Triangles:
    """The triangles of a mesh of polygons, those of a polygon one after the other.

    Attributes
    ----------
    faces : int64 (t, 3)
        Vertex indices.
    of_cut : pair of int64 (t,) and (t, 3), optional
        `polygon` and `corners`, unless all polygons are triangles.
    """

    faces: Ints
    of_cut: tuple[Ints, Ints] | None = None

    @property
    def polygon(self) -> Ints:
        """The polygon that each is cut from, int64 (t,)."""
        if self.of_cut is not None:
            return self.of_cut[0]
        return np.arange(len(self.faces), dtype=np.int64)

    @property
    def corners(self) -> Ints:
        """Indices of the polygons' corners, int64 (t, 3), for attributes of corners."""
        if self.of_cut is not None:
            return self.of_cut[1]
        return np.arange(self.faces.size, dtype=np.int64).reshape(-1, 3)


def triangulate(vertices: Floats, corners: Ints, offsets: Ints) -> Triangles:
    """Cut each polygon into two triangles less than it has corners.

    Nothing but the sequence of a polygon's positions decides, from whichever corner on. Polygons
    that are not in a plane are seen along their normal, the sum of the normals of any triangles
    that they are cut into.

    - Quads are cut along the shorter diagonal, unless a triangle is then turned against the normal
      or has no area, as at a reflex corner. Of diagonals that are equally long, it is that of the
      corner lowest along a slanted direction, so that regular meshes are cut regularly.
    - Convex polygons are cut into a fan around the corner that is the least in the order of
      positions.
    - Others are cut at their ears, slivers last. Where a hole is joined to the outline by a bridge
      that runs there and back, the triangles leave the hole open.

    The triangles of a simple polygon add up to its area. A polygon that crosses itself may have no
    triangles that do; neither has one without an area, such as one whose corners are in line. It is
    cut into a fan, whose triangles overlap and are turned over in part. So are a polygon with
    coordinates that are not finite, or larger than 1e307, and one of more than 65536 corners that
    is not convex.

    Parameters
    ----------
    vertices : float64 (n, 3)
    corners : int64 (c,)
    offsets : int64 (p + 1,)
        Polygons of at least three corners.
    """
    sizes = np.diff(offsets)
    if not len(sizes) or (sizes == 3).all():
        return Triangles(corners.reshape(-1, 3))
    around = np.zeros(len(sizes), dtype=np.int64)
    quads = np.flatnonzero(sizes == 4)
    for begin in range(0, len(quads), _AT_A_TIME):
        some = quads[begin : begin + _AT_A_TIME]
        around[some] = _diagonals(vertices[corners[offsets[some, None] + np.arange(4)]])
    larger = np.flatnonzero(sizes > 4)
    if not len(larger):
        return fans(corners, offsets, around)
    bounds = _bounds(sizes[larger])
    rows = _rows(offsets, larger, around)
    around[larger] = starts(vertices[corners[rows]], bounds)
    cut = fans(corners, offsets, around)
    rows = _rows(offsets, larger, around)
    x, y, has_plane = in_planes(vertices[corners[rows]], bounds)
    others = has_plane & ~_convex(x, y, bounds) & (sizes[larger] <= _LARGEST)
    if others.any():
        kept = np.repeat(others, sizes[larger])
        ears, done = clip_ears(x[kept], y[kept], _bounds(sizes[larger][others]))
        is_cut = np.zeros(len(sizes), dtype=np.bool_)
        is_cut[larger[others][done]] = True
        clipped = is_cut[cut.polygon]
        cut.corners[clipped] = rows[kept][ears]
        cut.faces[clipped] = corners[rows[kept][ears]]
    return cut


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
    return Triangles(corners[cut], (polygon, cut))


def _rows(offsets: Ints, chosen: Ints, around: Ints) -> Ints:
    """Return the corners of chosen polygons, each from its corner `around` on."""
    sizes = np.diff(offsets)[chosen]
    first, size = np.repeat(offsets[chosen], sizes), np.repeat(sizes, sizes)
    place = np.arange(len(size)) - np.repeat(_bounds(sizes)[:-1] - around[chosen], sizes)
    return first + np.where(place < size, place, place - size)


def _bounds(sizes: Ints) -> Ints:
    return np.concatenate((np.zeros(1, dtype=np.int64), np.cumsum(sizes)))


def _diagonals(points: Floats) -> Ints:
    """Return the corner, 0 or 1, of a diagonal at which to cut quads (q, 4, 3), int64 (q,).

    Every number is computed in the same way whichever corner is the first.
    """
    at = np.ascontiguousarray(points.transpose(1, 2, 0))
    with np.errstate(all="ignore"):  # coordinates beyond 1e307, or not finite: either, then
        at = at - at.min(axis=0)
        at = np.ldexp(at, -np.frexp(at.max(axis=(0, 1)))[1])
        edges = np.stack([at[1] - at[0], at[2] - at[1], at[3] - at[2], at[0] - at[3]])
        diagonals = at[2] - at[0], at[3] - at[1]
        normal = _cross(*diagonals)
        whole, (p, q, r, s) = (
            _dot(normal, normal),
            [_dot(normal, _cross(edges[i - 1], edges[i])) for i in range(4)],
        )
        worst = np.minimum(q, s), np.minimum(p, r)
        length = _dot(diagonals[0], diagonals[0]), _dot(diagonals[1], diagonals[1])
        both = np.minimum(*worst) > _SLIVER * whole
        even, odd = (np.where(both, a, -b) for a, b in zip(length, worst, strict=True))
        alike = np.where(both, np.abs(even - odd) < _ALIKE * (even + odd), ~(even != odd))
        along = sum(a * at[:, i] for i, a in enumerate(_SLANT))
        lowest = np.minimum(along[0], along[2]), np.minimum(along[1], along[3])
        second = np.where(alike, lowest[1] < lowest[0], odd < even).astype(np.int64)
        undecided = np.flatnonzero(alike & ~(lowest[0] != lowest[1]))
    if len(undecided):
        some = points[undecided].reshape(-1, 3)
        second[undecided] = starts(some, np.arange(0, len(some) + 1, 4)) % 2
    return second


def _cross(a: Floats, b: Floats) -> Floats:
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def _dot(a: Floats, b: Floats) -> Floats:
    product: Floats = a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    return product


def _convex(x: Floats, y: Floats, offsets: Ints) -> Bools:
    """Return which polygons turn to the left at every corner, and once in all, bool (p,)."""
    first, after = offsets[:-1], following(offsets)
    ax, ay = x[after] - x, y[after] - y
    bx, by = ax[after], ay[after]
    bend = ax * by - ay * bx > FLAT * np.sqrt((ax * ax + ay * ay) * (bx * bx + by * by))
    # The fan around corner 0, where x and y are 0.
    fan = x * y[after] - y * x[after] > 0
    fan[first] = fan[offsets[1:] - 1] = True
    return np.asarray(np.logical_and.reduceat(bend & fan, first))
