"""The polygons of a mesh, as rows of corners of its triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.mesh.outlines import walk
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.triangles import Triangles

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Polygons:
    """Which corners of the triangles (m, 3) of a file are those of its polygons.

    Attributes
    ----------
    corners : int64 (c,)
        A corner of a triangle, 3 * triangle + 0, 1 or 2, at each corner of a polygon, polygon
        after polygon; polygons ascend by their lowest triangle, and begin at that corner of it
        where most of their triangles meet.
    offsets : int64 (p + 1,)
        Where the corners of each polygon begin.
    of_corners : int64 (3 m,)
        The index into `corners` of the polygon's corner at which each triangle's corner is.
    """

    corners: _Ints
    offsets: _Ints
    of_corners: _Ints

    @cached_property
    def lowest(self) -> _Ints:
        """The lowest triangle of each polygon, int64 (p,)."""
        polygon = np.searchsorted(self.offsets, self.of_corners[::3], side="right") - 1
        return np.unique(polygon, return_index=True)[1]


@dataclass(frozen=True)
class Sources:
    """Where in the input the elements of a file come from.

    Attributes
    ----------
    vertices : int64 (n,)
    corners : int64 (c,)
        Of the polygons.
    faces : int64 (p,)
        The polygons.
    """

    vertices: _Ints
    corners: _Ints
    faces: _Ints


def plain(count: int) -> Polygons:
    """Return the polygons of a file of triangles, so many."""
    every = np.arange(3 * count)
    return Polygons(every, np.arange(0, 3 * count + 1, 3), every)


def joined(glued: _Ints) -> Polygons:
    """Return the polygons of glued triangles.

    Parameters
    ----------
    glued : int64 (3 m,)
        The half-edge that each half-edge is glued to, -1 for none; no triangles form a ring.
    """
    hidden = int(np.count_nonzero(glued >= 0))
    if not hidden:
        return plain(len(glued) // 3)
    corners = np.empty(len(glued) - hidden, dtype=np.int64)
    offsets = np.zeros(len(glued) // 3 - hidden // 2 + 1, dtype=np.int64)
    of_corners = np.empty_like(glued)
    walk(glued, corners, offsets, of_corners)
    return Polygons(corners, offsets, of_corners)


def sources_of(
    polygons: Polygons, vertices: _Ints, corners: _Ints, triangles: Triangles
) -> Sources:
    """Return where the elements of a file come from.

    Parameters
    ----------
    polygons : Polygons
        Of the file.
    vertices : int64 (n,)
        The input vertex of each vertex.
    corners : int64 (m, 3)
        The corner of `triangles` at each corner of the triangles of the file.
    triangles : Triangles
        Of the input.
    """
    came_from = corners.ravel()[polygons.corners]
    faces = triangles.polygon[came_from[polygons.offsets[:-1]] // 3]
    return Sources(vertices, triangles.corners.ravel()[came_from], faces)


def assembled(vertices: NDArray[np.float64], faces: _Ints, polygons: Polygons) -> PolyMesh:
    """Return the mesh of polygons of triangles (m, 3)."""
    return PolyMesh(vertices, faces.ravel()[polygons.corners], polygons.offsets)
