"""Domains of attributes: the vertices, corners and polygons of a file, with their neighbours."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from deltamesh._graph.elements import Elements, of_polygons
from deltamesh._shape.polygons import Polygons
from deltamesh._shape.structure import Structure
from deltamesh_formats.array_types import Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.polymesh.mesh import Domain


@dataclass(frozen=True)
class Domains:
    """The vertices, corners and polygons of a file, as encoder and decoder both know them.

    Attributes
    ----------
    structure : Structure
    """

    structure: Structure

    @property
    def polygons(self) -> Polygons:
        """The polygons of the file."""
        return self.structure.polygons

    def count(self, domain: Domain) -> int:
        """Return the number of elements of a domain."""
        counts = {
            "vertex": len(self.structure.points),
            "corner": len(self.polygons.corners),
            "face": len(self.polygons.offsets) - 1,
        }
        return counts[domain]

    @cached_property
    def vertices(self) -> Elements:
        """The vertices as elements, with the isolated ones."""
        return self.structure.vertices

    @cached_property
    def faces(self) -> Elements:
        """The polygons as elements."""
        s = self.structure
        return of_polygons(s.points[s.faces], self.polygons.offsets, self.polygons.of_corners)

    @cached_property
    def vertex_of_corners(self) -> Ints:
        """The vertex at each corner of the polygons, int64 (c,)."""
        return np.asarray(self.structure.faces.ravel()[self.polygons.corners])

    @cached_property
    def polygon_of_corners(self) -> Ints:
        """The polygon of each corner, int64 (c,)."""
        return np.repeat(np.arange(self.count("face")), np.diff(self.polygons.offsets))
