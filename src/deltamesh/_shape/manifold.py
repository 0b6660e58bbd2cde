"""Oriented manifold of triangles, and the stitches that make a complex of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._graph.halfedges import ends, pair_halfedges
from deltamesh._kernels.mesh import cutting
from deltamesh_formats.array_types import Bools, Ints
from deltamesh_formats.caching import cached_property

# The corners of a triangle whose winding is reversed.
REVERSED: Final = np.array([0, 2, 1])


@dataclass(frozen=True)
class Manifold:
    """Oriented manifold with boundary, in coding order.

    Attributes
    ----------
    faces : int64 (m, 3)
    vertex_count : int
        Number of its vertices, all of which are in faces.
    """

    faces: Ints
    vertex_count: int

    @cached_property
    def opposite(self) -> Ints:
        """The opposite of each half-edge, int64 (3 m,), -1 on the boundary."""
        return pair_halfedges(self.faces)

    @property
    def is_sound(self) -> bool:
        """Whether faces agree in winding across each edge, and each vertex has one fan."""
        start, end = ends(self.faces)
        inner = np.flatnonzero(self.opposite >= 0)
        across = self.opposite[inner]
        if (start[across] != end[inner]).any() or (end[across] != start[inner]).any():
            return False
        fan = np.empty(len(self.opposite), dtype=np.int64)
        return bool(cutting.label_fans(self.opposite, fan) == self.vertex_count)


@dataclass(frozen=True)
class CodedManifold:
    """Manifold in coding order, and where its elements are in the manifold before coding.

    Attributes
    ----------
    manifold : Manifold
    order : int64 (n,)
        The vertex that each vertex was.
    starts : int64 (m,)
        The half-edge with which each face begins.
    """

    manifold: Manifold
    order: Ints
    starts: Ints


@dataclass(frozen=True)
class Stitches:
    """How a manifold becomes a complex; the points are numbered as its vertices meet them.

    Attributes
    ----------
    points : int64 (n,)
        The point of each vertex of the manifold.
    reversed : bool (m,)
        The faces of the manifold that the complex has with their second and third corners
        exchanged.
    repeated : int64 (r,)
        Faces of the manifold that the complex has once more, ascending.
    against : bool (r,)
        Whether the winding of a repeat is opposite to that of the first; False before True.
    degenerate : int64 (d, 2)
        The points a and b of faces (a, a, b), in ascending order.
    """

    points: Ints
    reversed: Bools
    repeated: Ints
    against: Bools
    degenerate: Ints

    @cached_property
    def is_trivial(self) -> bool:
        """Whether the complex is the manifold itself."""
        one_each = len(self.points) == 0 or int(self.points[-1]) == len(self.points) - 1
        extras = len(self.repeated) + len(self.degenerate)
        return one_each and not self.reversed.any() and not extras


def trivial(vertex_count: int, face_count: int) -> Stitches:
    """Return the stitches of a manifold that is the complex itself."""
    none = np.zeros(0, dtype=np.int64)
    reversed_ = np.zeros(face_count, dtype=bool)
    return Stitches(np.arange(vertex_count), reversed_, none, reversed_[:0], none.reshape(0, 2))


def complex_faces(faces: Ints, stitches: Stitches) -> Ints:
    """Return the faces of the complex over points: those of the manifold, repeats, degenerates.

    Parameters
    ----------
    faces : int64 (m, 3)
        Of the manifold, in coding order.
    """
    s = stitches
    if s.is_trivial:
        return faces
    coded = s.points[faces]
    coded = np.where(s.reversed[:, None], coded[:, REVERSED], coded)
    again = coded[s.repeated]
    again = np.where(s.against[:, None], again[:, REVERSED], again)
    # Columns that an index has taken lie in another order, and kernels go by rows.
    return np.ascontiguousarray(np.concatenate([coded, again, s.degenerate[:, [0, 0, 1]]]))
