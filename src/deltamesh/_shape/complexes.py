"""Any set of triangles as an oriented manifold, with what it takes to have them back.

Faces that repeat a vertex, or another face, are set aside. The others are turned so that as many
neighbours as possible agree in winding; where two still do not (a Moebius strip), and where more
than two meet, the surface is cut along the edge; each fan of faces around a vertex gets a vertex
of its own (A. Gueziec, G. Taubin, F. Lazarus, W. Horn, "Cutting and stitching: converting sets of
polygons to manifold surfaces", IEEE TVCG 7(2), 2001: their local cutting, and pairs of faces are
left together as in their stitching).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.halfedges import by_edge, edges_of_two, ends
from deltamesh._kernels.mesh import cutting

_Ints = NDArray[np.int64]
_Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Cut:
    """An oriented manifold with boundary, and where it comes from.

    Attributes
    ----------
    faces : int64 (m, 3)
    opposite : int64 (3 m,)
        The half-edge on the other side of each half-edge, -1 on the boundary.
    points : int64 (n,)
        Of each of its vertices; several may be at one point.
    sources : int64 (m,)
        The face of the complex that each face was.
    turned : bool (m,)
        Whether its second and third corners were exchanged.
    repeats, repeated : int64 (r,)
        Faces of the complex with the vertices of another; the face, of `faces`, that they repeat.
    against : bool (r,)
        Whether their winding in the complex is the opposite of that face's in the complex.
    degenerate : int64 (d,)
        Faces of the complex that repeat a vertex.
    """

    faces: _Ints
    opposite: _Ints
    points: _Ints
    sources: _Ints
    turned: _Bools
    repeats: _Ints
    repeated: _Ints
    against: _Bools
    degenerate: _Ints


def cut(faces: _Ints, n: int) -> Cut:
    """Cut a complex of triangles into an oriented manifold.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of any kind, over points in [0, n).
    """
    collapsed = _collapsed(faces)
    degenerate, sources = np.flatnonzero(collapsed), np.flatnonzero(~collapsed)
    kept = faces[sources] if len(degenerate) else faces
    order, bounds = by_edge(*ends(kept))
    clean = _is_clean(kept, order, bounds)
    repeats, repeated, against = sources[:0], sources[:0], collapsed[:0]
    turned = np.zeros(len(kept), dtype=bool)
    if not clean:
        first, repeats, repeated, against = _repeats(kept)
        repeats, sources = sources[repeats], sources[first]
        kept = kept[first]
        order, bounds = by_edge(*ends(kept))
    opposite = np.full(3 * len(kept), -1, dtype=np.int64)
    if not clean:
        kept, turned = _pair(kept, order, bounds, opposite)
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
        sources,
        turned,
        repeats,
        repeated,
        against,
        degenerate,
    )


def distinct_faces(faces: _Ints) -> _Ints:
    """Return the faces (k, 3) that repeat no vertex; of equal ones, turned or not, the first."""
    collapsed = _collapsed(faces)
    faces = faces[~collapsed] if collapsed.any() else faces
    first = _repeats(faces)[0]
    return faces[first] if len(first) < len(faces) else faces


def _collapsed(faces: _Ints) -> _Bools:
    """Tell which faces repeat a vertex."""
    a, b, c = faces.T
    return np.asarray((a == b) | (b == c) | (c == a))


def _is_clean(faces: _Ints, order: _Ints, bounds: _Ints) -> bool:
    """Tell whether all edges have one face, or two that agree in winding."""
    first, second = edges_of_two(order, bounds)
    start = faces.ravel()
    return np.diff(bounds).max(initial=0) <= 2 and bool((start[first] != start[second]).all())


def _repeats(faces: _Ints) -> tuple[_Ints, _Ints, _Ints, _Bools]:
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


def _pair(faces: _Ints, order: _Ints, bounds: _Ints, opposite: _Ints) -> tuple[_Ints, _Bools]:
    """Fill in the opposites of the half-edges; return the faces, turned, and which were."""
    size = np.diff(bounds)
    first, second = edges_of_two(order, bounds)
    start = faces.ravel()
    component = np.arange(len(faces))
    turned = np.zeros(len(faces), dtype=bool)
    cutting.orient(first, second, start[first] == start[second], component, turned)
    faces = np.where(turned[:, None], faces[:, [0, 2, 1]], faces)
    # The half-edges of a turned face: 0, 1, 2 run along the edges of 2, 1, 0.
    h = np.arange(3 * len(faces))
    place = np.where(turned[h // 3], 3 * (h // 3) + 2 - h % 3, h)
    first, second, order = place[first], place[second], place[order]
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
    return faces, turned
