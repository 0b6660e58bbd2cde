"""Draft of a structure: the state of its encoder between two sections."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._graph.halfedges import weld
from deltamesh._shape.complexes import Cut, cut
from deltamesh._shape.manifold import Stitches
from deltamesh._shape.provenance import Provenance, TriangleProvenance, provenance_of
from deltamesh._shape.structure import EMPTY, Structure
from deltamesh_formats.array_types import Bools, Floats, Ints
from deltamesh_formats.caching import cached_property
from deltamesh_formats.polymesh.triangles import Triangles

_NONE: Final = np.zeros(0, dtype=np.int64)
_NOTHING: Final = TriangleProvenance(_NONE, _NONE, np.zeros((0, 3), dtype=np.int32))


@dataclass(frozen=True)
class Input:
    """Triangles of the input, and their points.

    Attributes
    ----------
    vertices : float64 (n, 3)
    triangles : Triangles
    first_vertices : int64 (w,)
        The first vertex at each position, ascending; the index of a position is that of its point.
    points : int64 (n,)
        The point of each vertex.
    in_face : bool (n,)
        Whether a vertex is in a face.
    kept : bool (n,)
        Whether a vertex is in the file.
    """

    vertices: Floats
    triangles: Triangles
    first_vertices: Ints
    points: Ints
    in_face: Bools
    kept: Bools


@dataclass(frozen=True)
class ShapeDraft:
    """State of the encoder of a structure.

    Attributes
    ----------
    input : Input
    cut : Cut or None
        Of the triangles over points; None once the manifold that they are cut into is coded.
    structure : Structure
        As a decoder knows it after the same sections.
    stitches : Stitches
        Those of the complex, once the manifold is coded.
    triangle_provenance : TriangleProvenance
        Of the elements of the structure, once its complex is stitched.
    """

    input: Input
    cut: Cut | None
    structure: Structure = EMPTY
    stitches: Stitches = EMPTY.complex.stitches
    triangle_provenance: TriangleProvenance = _NOTHING

    @property
    def points(self) -> Ints:
        """The point in coding order of each input vertex, (n,), -1 for those that are left out."""
        coded = np.full(len(self.input.first_vertices), -1, dtype=np.int64)
        at = self.triangle_provenance.points
        coded[self.input.points[at]] = np.arange(len(at))
        return coded[self.input.points]

    @cached_property
    def provenance(self) -> Provenance:
        """The provenance of the polygons of the structure."""
        polygons, triangles = self.structure.polygons, self.input.triangles
        return provenance_of(polygons, self.triangle_provenance, triangles)


def first_draft(
    vertices: Floats, triangles: Triangles, *, drop_isolated: bool, exact: bool
) -> ShapeDraft:
    """Weld the vertices of triangles and cut these into a manifold.

    Parameters
    ----------
    vertices : float64 (n, 3)
    triangles : Triangles
    drop_isolated : bool
        Leave out the vertices that are in no face.
    exact : bool
        Whether 0.0 and -0.0 are different positions.
    """
    first, points = weld(vertices, exact=exact)
    in_face = np.zeros(len(vertices), dtype=bool)
    in_face[triangles.faces] = True
    kept = in_face if drop_isolated else np.ones(len(vertices), dtype=bool)
    manifold = cut(points[triangles.faces], len(first))
    return ShapeDraft(Input(vertices, triangles, first, points, in_face, kept), manifold)
