"""Polygons of a mesh, as rows of corners of its triangles."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._kernels.mesh.outlines import walk
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles


@dataclass(frozen=True)
class Polygons:
    """Corners of the triangles (m, 3) of a file that are those of its polygons.

    Attributes
    ----------
    corners : int64 (c,)
        A corner of a triangle, 3 * triangle + 0, 1 or 2, for each corner of a polygon, polygon
        after polygon; polygons ascend by their lowest triangle, and begin at that corner of it
        where most of their triangles meet.
    offsets : int64 (p + 1,)
        Where the corners of each polygon begin.
    of_corners : int64 (3 m,)
        The index into `corners` of the polygon's corner at which each triangle's corner is.
    """

    corners: Ints
    offsets: Ints
    of_corners: Ints

    @cached_property
    def lowest(self) -> Ints:
        """The lowest triangle of each polygon, int64 (p,)."""
        polygon = np.searchsorted(self.offsets, self.of_corners[::3], side="right") - 1
        return np.unique(polygon, return_index=True)[1]


def plain(count: int) -> Polygons:
    """Return the polygons of a file of `count` triangles."""
    every = np.arange(3 * count)
    return Polygons(every, np.arange(0, 3 * count + 1, 3), every)


def merged_polygons(merged: Ints) -> Polygons:
    """Return the polygons of merged triangles.

    Parameters
    ----------
    merged : int64 (3 m,)
        The half-edge that each half-edge is merged with, -1 for none; no triangles form a ring.
    """
    hidden = int(np.count_nonzero(merged >= 0))
    if not hidden:
        return plain(len(merged) // 3)
    corners = np.empty(len(merged) - hidden, dtype=np.int64)
    offsets = np.zeros(len(merged) // 3 - hidden // 2 + 1, dtype=np.int64)
    of_corners = np.empty_like(merged)
    walk(merged, corners, offsets, of_corners)
    return Polygons(corners, offsets, of_corners)


def assembled(vertices: Floats, faces: Ints, polygons: Polygons | None) -> PolyMesh:
    """Return the mesh of polygons of triangles (m, 3), or of these: no copy is made of them."""
    if polygons is None:
        return from_triangles(vertices, faces)
    return PolyMesh(vertices, faces.ravel()[polygons.corners], polygons.offsets)
