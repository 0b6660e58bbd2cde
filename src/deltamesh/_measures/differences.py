"""Differences of a mesh from a reference: of each vertex, each face and each edge.

They are computed from differences of positions, so that nothing is lost far from the origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._graph.halfedges import by_edge, ends
from deltamesh._kernels.mesh import differences as kernels
from deltamesh_formats.array_types import Bools, Floats, Ints, Shorts
from deltamesh_formats.caching import cached_property

# A face has lost its area where less than that share of it is left.
LOST: Final = 1e-3
# Degrees by which a face has turned over.
TURNED: Final = 90.0


@dataclass(frozen=True)
class Differences:
    """Differences of a mesh from a reference.

    Attributes
    ----------
    distance : float64 (n,)
        From each vertex to where it was, in the unit of the reference.
    angle : float64 (m,)
        Between the normals of each face, in degrees; 90 where a face has become a line or a point.
    change : float64 (e,)
        Of the dihedral angle at each interior edge, in degrees, at most 180.
    lost, turned : bool (m,)
        Which faces had an area of which less than a thousandth is left; which of the others had one
        and are turned over.
    area : float
        Of all faces, over what it was; 1 if there was none.
    """

    distance: Floats
    angle: Floats
    change: Floats
    lost: Bools
    turned: Bools
    area: float


@dataclass(frozen=True)
class Reference:
    """Reference of differences; what they need of it is computed once.

    Attributes
    ----------
    vertices : float64 (n, 3)
    faces : int64 (m, 3)
    unit : float
        Length in which distances and areas are measured.
    """

    vertices: Floats
    faces: Ints
    unit: float

    @cached_property
    def areas(self) -> Floats:
        """Twice the areas of the faces in the square unit, (m,)."""
        return self._normals_and_areas(self.vertices)[1]

    @cached_property
    def edges(self) -> Shorts:
        """The interior edges, int32 (e, 2); see `_interior_edges`."""
        return _interior_edges(self.faces)

    @cached_property
    def _dihedral(self) -> Floats:
        return self._dihedral_angles(self.vertices, self._normals_and_areas(self.vertices)[0])

    def _normals_and_areas(self, W: Floats) -> tuple[Floats, Floats]:
        return kernels.face_normals(W, self.faces, self.unit)

    def _dihedral_angles(self, W: Floats, normals: Floats) -> Floats:
        return kernels.dihedral_angles(W, normals, self.faces, self.edges)

    def differences(self, W: Floats) -> Differences:
        """Return the differences of other positions of the vertices, float64 (n, 3).

        Raises
        ------
        ValueError
            If they are not as many.
        """
        V = self.vertices
        if V.shape != W.shape:
            raise ValueError(f"{len(V)} and {len(W)} vertices cannot be compared one by one")
        dihedral = self._dihedral
        # Normals are found again: to keep those of the reference takes 96 bytes a vertex.
        before, after = self._normals_and_areas(V), self._normals_and_areas(W)
        angle, lost, turned = kernels.face_changes(before, after, LOST, TURNED)
        areas = float(before[1].sum()), float(after[1].sum())
        area = areas[1] / areas[0] if areas[0] else 1.0
        change = self._dihedral_angles(W, after[0])
        del before, after
        change -= dihedral
        np.abs(change, out=change)
        np.minimum(change, 360 - change, out=change)
        return Differences(kernels.distances(V, W, self.unit), angle, change, lost, turned, area)


def _interior_edges(F: Ints) -> Shorts:
    """Return the edges of exactly two faces, as their half-edges of these, int32 (e, 2).

    The half-edge of the face with the lower index comes first.
    """
    start, end = ends(F)
    order, bounds = by_edge(start, end)
    two = bounds[:-1][np.diff(bounds) == 2]
    pairs = np.empty((len(two), 2), dtype=np.int32)
    pairs[:, 0], pairs[:, 1] = order[two], order[two + 1]
    del order, bounds, two
    h, g = pairs.T
    inner = (h // 3 != g // 3) & (start[h] != end[h])
    return pairs if inner.all() else pairs[inner]
