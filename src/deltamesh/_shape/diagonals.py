"""Cut of the polygons of a mesh into triangles to be coded.

A decoder joins the triangles again, so that any diagonals will do. Where quads meet in a grid,
diagonals that all run in parallel give every vertex a valence of 6, which costs nearly nothing:
of two quads that share an edge, the diagonals should end at different ends of it.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._graph.halfedges import by_edge, edges_of_two, ends, weld
from deltamesh._kernels.mesh import diagonals as kernels
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import Triangles, fans

# Each corner is tried as the middle of the fan, which is quadratic in the size of the polygon.
_LARGEST_TRIED: Final = 16


def cut_polygons(mesh: PolyMesh) -> Triangles:
    """Cut polygons into fans, which a decoder joins again even where they fold.

    A fan is around the first corner of a polygon, so that regular meshes are cut regularly, unless
    a triangle of that fan is turned against the polygon or has no area, as at a reflex corner. Then
    it is around the corner whose fan has the best worst triangle: the largest least product of a
    triangle's normal with the polygon's. Polygons of more than 16 corners always take the first.
    """
    if (mesh.sizes == 3).all():
        return mesh.triangulation()
    around = middles(mesh.vertices, mesh.corners, mesh.offsets)
    quads = np.flatnonzero(mesh.sizes == 4)
    around[quads] = _parallel(mesh, quads, around[quads])
    return fans(mesh.corners, mesh.offsets, around)


def _parallel(mesh: PolyMesh, quads: Ints, around: Ints) -> Ints:
    """Return the corner, 0 or 1, at which the diagonal of each quad ends.

    `around` (q,) are the corners to take where one of the two diagonals folds the quad.
    """
    corners = mesh.corners[mesh.offsets[quads, None] + np.arange(4)]
    points = mesh.vertices[corners]
    given = np.where(_folds(points, 0) | _folds(points, 1), around % 2, -1)
    first, second, same_way = _shared_edges(weld(mesh.vertices)[1][corners])
    # Corners of even index are ends of diagonal 0, those of odd index of diagonal 1.
    unlike = ((first ^ second) & 1) ^ same_way
    quad, other = np.concatenate([first, second]) // 4, np.concatenate([second, first]) // 4
    order = np.argsort(quad, kind="stable")
    start = np.zeros(len(quads) + 1, dtype=np.int64)
    np.cumsum(np.bincount(quad, minlength=len(quads)), out=start[1:])
    kernels.choose(start, other[order], np.tile(unlike, 2)[order], given)
    return given


def _shared_edges(quads: Ints) -> tuple[Ints, Ints, Ints]:
    """Return the edges of just two quads, (q, 4), as two half-edges, 4 * quad + corner.

    The third array is 1 where these run the same way, else 0.
    """
    start, end = ends(quads)
    first, second = edges_of_two(*by_edge(start, end))
    return first, second, (start[first] == start[second]).astype(np.int64)


def middles(vertices: Floats, corners: Ints, offsets: Ints) -> Ints:
    """Return the corner around which to cut each polygon, int64 (p,)."""
    sizes = np.diff(offsets)
    around = np.zeros(len(sizes), dtype=np.int64)
    for size in np.unique(sizes).tolist():
        if 3 < size <= _LARGEST_TRIED:
            chosen = np.flatnonzero(sizes == size)
            at = offsets[chosen, None] + np.arange(size)
            around[chosen] = _middles(vertices[corners[at]])
    return around


def _folds(points: Floats, corner: int) -> Bools:
    """Return which polygons of one size, (q, size, 3), the fan around a corner folds, bool (q,)."""
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
