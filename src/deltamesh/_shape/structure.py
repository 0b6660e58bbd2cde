"""Structure of a mesh: everything but its positions, known to encoder and decoder.

Manifold -> complex of triangles over points -> triangles over vertices -> polygons: the sections
CONN, STCH, COPY and POLY each add a step, and what follows from a step is computed once.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._graph.elements import Elements, of_vertices
from deltamesh._graph.parallelograms import NO_QUADS
from deltamesh._shape.manifold import Manifold, Stitches, complex_faces, trivial
from deltamesh._shape.merge_candidates import hidden_halfedges, merge_candidates
from deltamesh._shape.polygons import Polygons, merged_polygons, plain
from deltamesh._shape.surface import NO_EDGES, Surface, surface_of
from deltamesh._shape.wedges import Corners, corners_of
from deltamesh_formats.array_types import Ints
from deltamesh_formats.caching import cached_property

_NONE: Final = np.zeros(0, dtype=np.int64)


@dataclass(frozen=True)
class Complex:
    """Triangles over points: a manifold that is stitched, with repeated and degenerate faces.

    Attributes
    ----------
    manifold : Manifold
    stitches : Stitches
    used : int
        Number of points that the faces of the manifold have.
    isolated : int
        Number of further points, which come after them.
    """

    manifold: Manifold
    stitches: Stitches
    used: int
    isolated: int

    @property
    def point_count(self) -> int:
        """Number of points."""
        return self.used + self.isolated

    @cached_property
    def faces(self) -> Ints:
        """All triangles over points, (m, 3)."""
        return complex_faces(self.manifold.faces, self.stitches)

    @cached_property
    def manifold_faces(self) -> Ints:
        """The faces of the manifold over points, (k, 3)."""
        s, faces = self.stitches, self.manifold.faces
        return faces if s.is_trivial else s.points[faces]

    @cached_property
    def corners(self) -> Corners:
        """The corners of the triangles, point by point."""
        m = self.manifold
        return corners_of(m.faces, m.opposite, self.stitches, self.point_count)


@dataclass(frozen=True)
class Structure:
    """Mesh without its positions.

    Attributes
    ----------
    complex : Complex
    faces : int64 (m, 3)
        The triangles of the complex, over vertices.
    points : int64 (n,)
        The point of each vertex, ascending.
    merged : int64 (3 m,) or (0,)
        The half-edge that each half-edge of `faces` is merged with in a polygon, -1 for none;
        nothing if all polygons are triangles.
    """

    complex: Complex
    faces: Ints
    points: Ints
    merged: Ints

    @property
    def corners(self) -> Corners:
        """The corners of the triangles, point by point."""
        return self.complex.corners

    @property
    def has_split_vertices(self) -> bool:
        """Whether several vertices are at one point."""
        return len(self.points) != self.complex.point_count

    @property
    def split_points(self) -> Ints:
        """The points of the vertices if some are split, else nothing: a part of the digest."""
        return self.points if self.has_split_vertices else _NONE

    @cached_property
    def merge_candidates(self) -> Ints:
        """The half-edge that each may be merged with, (3 m,), -1 for none."""
        c = self.complex
        return merge_candidates(self.faces, c.manifold.opposite, c.stitches.reversed)

    @cached_property
    def polygons(self) -> Polygons:
        """The polygons of the mesh."""
        return merged_polygons(self.merged) if len(self.merged) else plain(len(self.faces))

    @cached_property
    def surface(self) -> Surface:
        """The surface over points on which geometry is coded."""
        c, hidden = self.complex, NO_EDGES
        if len(self.merged):
            hidden = hidden_halfedges(self.merged, c.manifold.opposite, c.stitches.reversed)
        manifold = c.manifold if c.stitches.is_trivial else None
        faces = c.manifold_faces
        return surface_of(faces, c.used, c.isolated, hidden, self._quads(), manifold)

    @cached_property
    def vertices(self) -> Elements:
        """The vertices as elements, isolated ones included, over the edges of all triangles."""
        trivial_everywhere = self.complex.stitches.is_trivial and not self.has_split_vertices
        if trivial_everywhere and not len(self.merged):
            return self.surface.elements
        opposite = self.complex.manifold.opposite if trivial_everywhere else None
        return of_vertices(self.faces, len(self.points), opposite)

    def _quads(self) -> Ints:
        """Return the polygons of four corners, (q, 4), over points."""
        if not len(self.merged):
            return NO_QUADS
        corners, offsets = self.polygons.corners, self.polygons.offsets
        first = offsets[:-1][np.diff(offsets) == 4]
        quads: Ints = corners[first[:, None] + np.arange(4)]
        return np.asarray(self.points[self.faces.ravel()[quads]])


def structure_of(built: Complex) -> Structure:
    """Return the structure of a complex with a vertex at each point, and triangles only."""
    points = built.stitches.points
    if not built.stitches.is_trivial or len(points) < built.point_count:
        points = np.arange(built.point_count)
    return Structure(built, built.faces, points, _NONE)


# The structure before the first section.
EMPTY: Final = structure_of(Complex(Manifold(np.zeros((0, 3), np.int64), 0), trivial(0, 0), 0, 0))
