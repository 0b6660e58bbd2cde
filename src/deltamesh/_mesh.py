"""Triangle mesh, the pair of arrays that the codec works on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.polymesh.mesh import PolyMesh

# The squares of coordinates, and of their sums, have to stay within double precision.
LARGEST: Final = 1e150


@dataclass(frozen=True)
class TriangleMesh:
    """A triangle mesh.

    Attributes
    ----------
    vertices : float64 (n, 3)
        Positions, in the unit of the source.
    faces : int64 (m, 3)
        Vertex indices from 0, counter-clockwise seen from outside.
    """

    vertices: Floats
    faces: Ints


def triangulated(mesh: PolyMesh) -> TriangleMesh:
    """Return the triangles of a mesh of polygons."""
    return TriangleMesh(mesh.vertices, mesh.triangles)
