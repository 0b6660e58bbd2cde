"""Provenance of the elements of a file: their elements in the input."""

from __future__ import annotations

from dataclasses import dataclass

from deltamesh._shape.polygons import Polygons
from deltamesh_formats.array_types import Ints, Shorts
from deltamesh_formats.polymesh.triangles import Triangles


@dataclass(frozen=True)
class TriangleProvenance:
    """Provenance before triangles are merged into polygons.

    Attributes
    ----------
    points : int64 (p,)
        An input vertex at each point.
    vertices : int64 (n,)
        The input vertex of each vertex.
    corners : int32 (m, 3)
        The corner of the input's triangles, 3 * triangle + 0, 1 or 2, at each corner.
    """

    points: Ints
    vertices: Ints
    corners: Shorts


@dataclass(frozen=True)
class Provenance:
    """Provenance of the vertices, corners and polygons of a file.

    Attributes
    ----------
    vertices : int64 (n,)
        The input vertex of each vertex.
    corners : int64 (c,)
        The corner of the input's polygons at each corner of a polygon.
    polygons : int64 (p,)
        The input polygon of each polygon.
    """

    vertices: Ints
    corners: Ints
    polygons: Ints


def provenance_of(
    polygons: Polygons, provenance: TriangleProvenance, triangles: Triangles
) -> Provenance:
    """Return the provenance of the polygons of a file.

    Parameters
    ----------
    polygons : Polygons
        Of the file.
    provenance : TriangleProvenance
        Of its triangles.
    triangles : Triangles
        Of the input.
    """
    corners = provenance.corners.ravel()[polygons.corners]
    found = triangles.polygon[corners[polygons.offsets[:-1]] // 3]
    return Provenance(provenance.vertices, triangles.corners.ravel()[corners], found)
