"""Cut of any set of triangles into an oriented manifold, with what it takes to have them back.

Faces that repeat a vertex, or another face, are set aside. The others are oriented so that as many
neighbours as possible agree in winding; where two still do not (a Moebius strip), and where more
than two meet, the surface is cut along the edge; each fan of faces around a vertex gets a vertex
of its own (A. Gueziec, G. Taubin, F. Lazarus, W. Horn, "Cutting and stitching: converting sets of
polygons to manifold surfaces", IEEE TVCG 7(2), 2001: their local cutting, and pairs of faces are
left together as in their stitching).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._graph.halfedges import by_edge, edges_of_two, ends
from deltamesh._kernels.mesh import cutting
from deltamesh_formats.array_types import Bools, Ints


@dataclass(frozen=True)
class Cut:
    """Oriented manifold with boundary, and what it was cut from.

    Attributes
    ----------
    faces : int64 (m, 3)
    opposite : int64 (3 m,)
        The half-edge on the other side of each half-edge, -1 on the boundary.
    points : int64 (n,)
        The point of each of its vertices; several may be at one point.
    triangles : int64 (m,)
        The triangle of the complex that each face was.
    reversed : bool (m,)
        Whether its second and third corners were exchanged.
    repeats, repeated : int64 (r,)
        Faces of the complex with the vertices of another; the face, of `faces`, that they repeat.
    against : bool (r,)
        Whether their winding in the complex is the opposite of that face's in the complex.
    degenerate : int64 (d,)
        Faces of the complex that repeat a vertex.
    """

    faces: Ints
    opposite: Ints
    points: Ints
    triangles: Ints
    reversed: Bools
    repeats: Ints
    repeated: Ints
    against: Bools
    degenerate: Ints


def cut(faces: Ints, n: int) -> Cut:
    """Cut a complex of triangles into an oriented manifold.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of any kind, over points in [0, n).
    """
    collapsed = _collapsed(faces)
    degenerate, triangles = np.flatnonzero(collapsed), np.flatnonzero(~collapsed)
    kept = faces[triangles] if len(degenerate) else faces
    order, bounds = by_edge(*ends(kept))
    clean = _is_clean(kept, order, bounds)
    repeats, repeated, against = triangles[:0], triangles[:0], collapsed[:0]
    reversed_ = np.zeros(len(kept), dtype=bool)
    if not clean:
        first, repeats, repeated, against = _repeats(kept)
        repeats, triangles = triangles[repeats], triangles[first]
        kept = kept[first]
        order, bounds = by_edge(*ends(kept))
    opposite = np.full(3 * len(kept), -1, dtype=np.int64)
    if not clean:
        kept, reversed_ = _pair(kept, order, bounds, opposite)
    else:
        first, second = edges_of_two(order, bounds)
        opposite[first], opposite[second] = second, first
    label = np.empty(3 * len(kept), dtype=np.int64)
    count = cutting.label_fans(opposite, label)
    if not clean:
        cutting.break_slits(opposite, label, count)
        count = cutting.label_fans(opposite, label)
    points = np.empty(count, dtype=np.int64)
    points[label] = kept.ravel()
    return Cut(
        label.reshape(-1, 3),
        opposite,
        points,
        triangles,
        reversed_,
        repeats,
        repeated,
        against,
        degenerate,
    )


def distinct_faces(faces: Ints) -> Ints:
    """Return which faces repeat no vertex, int64 (k,); of equal ones, in any winding, the first."""
    kept = np.flatnonzero(~_collapsed(faces))
    return kept[_repeats(faces[kept])[0]]


def _collapsed(faces: Ints) -> Bools:
    """Return which faces repeat a vertex."""
    a, b, c = faces.T
    return np.asarray((a == b) | (b == c) | (c == a))


def _is_clean(faces: Ints, order: Ints, bounds: Ints) -> bool:
    """Return whether all edges have one face, or two that agree in winding."""
    first, second = edges_of_two(order, bounds)
    start = faces.ravel()
    return np.diff(bounds).max(initial=0) <= 2 and bool((start[first] != start[second]).all())


def _repeats(faces: Ints) -> tuple[Ints, Ints, Ints, Bools]:
    """Return the first face of each set of vertices; the others, which each repeats, and how.

    The second array are indices of faces, the third indices of the first array.
    """
    corners = np.sort(faces, axis=1)
    order = np.lexsort(corners.T)  # stable: the lowest face of a set comes first
    new = np.ones(len(faces), dtype=bool)
    new[1:] = (corners[order[1:]] != corners[order[:-1]]).any(axis=1)
    first = order[new]
    base = np.empty(len(faces), dtype=np.int64)
    base[order] = first[np.cumsum(new) - 1]
    is_first = np.zeros(len(faces), dtype=bool)
    is_first[first] = True
    others = np.flatnonzero(~is_first)
    even = (faces < np.roll(faces, -1, axis=1)).sum(axis=1) == 2
    rank = np.cumsum(is_first) - 1
    return np.flatnonzero(is_first), others, rank[base[others]], even[others] != even[base[others]]


def _pair(faces: Ints, order: Ints, bounds: Ints, opposite: Ints) -> tuple[Ints, Bools]:
    """Fill in the opposites of half-edges; return the oriented faces, and which are reversed."""
    size = np.diff(bounds)
    first, second = edges_of_two(order, bounds)
    start = faces.ravel()
    component = np.arange(len(faces))
    reversed_ = np.zeros(len(faces), dtype=bool)
    cutting.orient(first, second, start[first] == start[second], component, reversed_)
    faces = np.where(reversed_[:, None], faces[:, [0, 2, 1]], faces)
    # The half-edges of a reversed face: 0, 1, 2 run along the edges of 2, 1, 0.
    h = np.arange(3 * len(faces))
    renamed = np.where(reversed_[h // 3], 3 * (h // 3) + 2 - h % 3, h)
    first, second, order = renamed[first], renamed[second], renamed[order]
    start, end = ends(faces)
    agree = start[first] != start[second]
    first, second = first[agree], second[agree]
    opposite[first], opposite[second] = second, first
    many = np.flatnonzero(size > 2)
    if len(many):
        edge = np.repeat(np.arange(len(size)), size)
        chosen = np.flatnonzero((size > 2)[edge])
        halfedges = order[chosen]
        by = np.lexsort((component[halfedges // 3], edge[chosen]))
        limits = np.concatenate(([0], np.cumsum(size[many])))
        cutting.pair_up(halfedges[by], limits, start < end, component, opposite)
    return faces, reversed_
