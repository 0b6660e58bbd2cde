"""Differences of a mesh from a reference: of each vertex, each face and each edge.

They are computed from differences of positions, so that nothing is lost far from the origin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._graph.halfedges import by_edge, edges_of_two, ends
from deltamesh._kernels.mesh import differences as kernels
from deltamesh_formats.array_types import Bools, Floats, Ints
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

    @property
    def normals(self) -> Floats:
        """The normals of the faces, (m, 3), of any length."""
        return self._normals_and_areas[0]

    @property
    def areas(self) -> Floats:
        """Twice the areas of the faces in the square unit, (m,)."""
        return self._normals_and_areas[1]

    @cached_property
    def _normals_and_areas(self) -> tuple[Floats, Floats]:
        return kernels.face_normals(self.vertices, self.faces, self.unit)

    @cached_property
    def edges(self) -> tuple[Ints, Ints, Ints, Bools]:
        """The interior edges; see `_interior_edges`."""
        return _interior_edges(self.faces)

    @cached_property
    def _dihedral(self) -> Floats:
        return kernels.dihedral_angles(self.vertices, self.normals, *self.edges)

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
        after = kernels.face_normals(W, self.faces, self.unit)
        angle, lost, turned = kernels.face_changes(self._normals_and_areas, after, LOST, TURNED)
        change = np.abs(kernels.dihedral_angles(W, after[0], *self.edges) - self._dihedral)
        np.minimum(change, 360 - change, out=change)
        before, now = float(self.areas.sum()), float(after[1].sum())
        area = now / before if before else 1.0
        return Differences(kernels.distances(V, W, self.unit), angle, change, lost, turned, area)


def _interior_edges(F: Ints) -> tuple[Ints, Ints, Ints, Bools]:
    """Return the edges of exactly two faces.

    Returns
    -------
    edges : int64 (e, 2)
        As the first face runs through them.
    left, right : int64 (e,)
        The faces; the first has the lower index.
    same : bool (e,)
        Whether both run through it in the same direction: then one of them is turned over.
    """
    a, b = ends(F)
    h, g = edges_of_two(*by_edge(a, b))
    pairs = np.stack((a[h], b[h]), axis=1)
    two = (h // 3 != g // 3) & (pairs[:, 0] != pairs[:, 1])
    return pairs[two], h[two] // 3, g[two] // 3, (a[h] == a[g])[two]
