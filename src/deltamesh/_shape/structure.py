"""Everything of a mesh but its positions, as both sides know it.

`structure_encoding` and `structure_decoding` make it, of any triangles and of a file.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._shape.corners import Corners, corners_of
from deltamesh._shape.merging import hidden_halfedges, partners
from deltamesh._shape.polygons import Polygons, joined, plain
from deltamesh._shape.stitching import Stitching
from deltamesh._shape.surface import NO_EDGES, Surface, surface_of

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Structure:
    """A mesh without its positions, as both sides know it.

    Attributes
    ----------
    manifold : int64 (k, 3)
        The faces that CONN has, over vertices of its own.
    stitching : Stitching
        What makes a complex of them.
    used, isolated : int
        Points of these faces; further points, which come after them.
    faces : int64 (m, 3)
        Of the mesh, over its vertices.
    points : int64 (n,)
        The point of each vertex, ascending.
    glued : int64 (3 m,) or (0,)
        The half-edge of the mesh that each is glued to in a polygon, -1 for none; nothing if all
        polygons are triangles.
    """

    manifold: _Ints
    stitching: Stitching
    used: int
    isolated: int
    faces: _Ints
    points: _Ints
    glued: _Ints = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @cached_property
    def point_faces(self) -> _Ints:
        """The faces of the manifold over points, (k, 3)."""
        return self.stitching.points[self.manifold]

    @cached_property
    def surface(self) -> Surface:
        """What geometry is coded on."""
        return surface_of(self.point_faces, self.used, self.isolated, self.hidden, self.quads)

    @cached_property
    def opposite(self) -> _Ints:
        """Of the half-edges of the manifold, (3 k,), as of `topology.pair_halfedges`."""
        return pair_halfedges(self.manifold)

    @cached_property
    def corners(self) -> Corners:
        """The corners of the complex, point by point."""
        count = self.used + self.isolated
        return corners_of(self.manifold, self.opposite, self.stitching, count)

    @cached_property
    def partners(self) -> _Ints:
        """The half-edge of the mesh that each may be glued to, (3 m,), or -1."""
        return partners(self.faces, self.opposite, self.stitching.turned)

    @cached_property
    def polygons(self) -> Polygons:
        """The polygons of the mesh."""
        return joined(self.glued) if len(self.glued) else plain(len(self.faces))

    @cached_property
    def hidden(self) -> NDArray[np.bool_]:
        """Half-edges of the manifold, (3 k,), within a polygon; (0,) if all are triangles."""
        if not len(self.glued):
            return NO_EDGES
        return hidden_halfedges(self.glued, self.opposite, self.stitching.turned)

    @property
    def quads(self) -> _Ints:
        """The polygons of four corners, (q, 4), over points."""
        corners, offsets = self.polygons.corners, self.polygons.offsets
        first = offsets[:-1][np.diff(offsets) == 4]
        quads: _Ints = corners[first[:, None] + np.arange(4)]
        return np.asarray(self.points[self.faces.ravel()[quads]])

    @property
    def glue(self) -> tuple[_Ints, ...]:
        """What the digest of a file covers of its polygons."""
        return (self.glued,) if len(self.glued) else ()

    @property
    def copied(self) -> _Ints:
        """The points where some have several vertices; else nothing."""
        return self.points[: 0 if len(self.points) == self.used + self.isolated else None]
