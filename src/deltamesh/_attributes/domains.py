"""What attributes belong to, in the order of the file, and what of it is near what."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from deltamesh._graph.elements import Elements, of_polygons
from deltamesh._shape.polygons import Polygons
from deltamesh._shape.structure import Structure
from deltamesh_formats.polymesh.mesh import Domain

_Ints = NDArray[np.int64]


@dataclass(frozen=True)
class Places:
    """The vertices, corners and faces of a file, known to encoder and decoder.

    Attributes
    ----------
    structure : Structure
    """

    structure: Structure

    @property
    def polygons(self) -> Polygons:
        """Those of the file."""
        return self.structure.polygons

    def count(self, domain: Domain) -> int:
        """Return how many elements a domain has."""
        counts = {
            "vertex": len(self.structure.points),
            "corner": len(self.polygons.corners),
            "face": len(self.polygons.offsets) - 1,
        }
        return counts[domain]

    @cached_property
    def vertices(self) -> Elements:
        """The vertices, those in no face too."""
        return self.structure.vertices

    @cached_property
    def faces(self) -> Elements:
        """The polygons."""
        s = self.structure
        return of_polygons(s.points[s.faces], self.polygons.offsets, self.polygons.of_corners)

    @cached_property
    def face_of_corners(self) -> _Ints:
        """The polygon of each corner, (c,)."""
        return np.repeat(np.arange(self.count("face")), np.diff(self.polygons.offsets))
