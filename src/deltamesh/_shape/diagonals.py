"""Cut of the polygons of a mesh into triangles to be coded.

A decoder joins the triangles again, so that any diagonals will do. Where quads meet in a grid,
diagonals that all run in parallel give every vertex a valence of 6, which costs nearly nothing:
of two quads that share an edge, the diagonals should end at different ends of it.
"""

from __future__ import annotations

import numpy as np

from deltamesh._graph.halfedges import by_edge, edges_of_two, ends, weld
from deltamesh._kernels.mesh import diagonals as kernels
from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import Triangles, fans, folds


def cut_polygons(mesh: PolyMesh, around: Ints) -> Triangles:
    """Cut polygons into fans.

    Parameters
    ----------
    mesh : PolyMesh
    around : int64 (p,)
        The corner around which any reader cuts each polygon, as `triangles.middles` returns it.
    """
    if (mesh.sizes == 3).all():
        return mesh.triangulation()
    around = around.copy()
    quads = np.flatnonzero(mesh.sizes == 4)
    around[quads] = _parallel(mesh, quads, around[quads])
    return fans(mesh.corners, mesh.offsets, around)


def _parallel(mesh: PolyMesh, quads: Ints, around: Ints) -> Ints:
    """Return the corner, 0 or 1, at which the diagonal of each quad ends.

    `around` (q,) are the corners to take where one of the two diagonals folds the quad.
    """
    corners = mesh.corners[mesh.offsets[quads, None] + np.arange(4)]
    points = mesh.vertices[corners]
    given = np.where(folds(points, 0) | folds(points, 1), around % 2, -1)
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
