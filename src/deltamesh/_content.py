"""Content of a file, known exactly to encoder and decoder, and the mesh that it makes."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Final

import numpy as np

from deltamesh._attributes.domains import Domains
from deltamesh._geometry.integers import NO_POINTS, NONE, Integers
from deltamesh._geometry.poses import Pose
from deltamesh._parts import Annotations
from deltamesh._shape.polygons import assembled
from deltamesh._shape.structure import EMPTY, Structure
from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

if TYPE_CHECKING:  # imported where there is one, since many meshes have none
    from deltamesh._attributes.section import CodedAttribute
    from deltamesh._order.reordering import Order


@dataclass(frozen=True)
class Content:
    """Content of a file beside its parameters, as far as its sections are coded.

    Attributes
    ----------
    domains : Domains
        The vertices, corners and polygons of the structure.
    integers : Integers
        Of the geometry.
    attributes : tuple of CodedAttribute
    annotations : Annotations or None
        Parts, names, transforms and metadata.
    order : Order or None
        The order of the input, where it is kept.
    poses : tuple of Pose
    """

    domains: Domains
    integers: Integers
    attributes: tuple[CodedAttribute, ...] = ()
    annotations: Annotations | None = None
    order: Order | None = None
    poses: tuple[Pose, ...] = ()

    @property
    def structure(self) -> Structure:
        """The mesh without its positions."""
        return self.domains.structure

    @property
    def points(self) -> Ints:
        """The point of each vertex of the mesh, int64 (n,)."""
        points = self.structure.points
        return points if self.order is None else points[self.order.vertices]

    def digest(self) -> bytes:
        """Return the checksum in CHEK (SPEC.md 5.7)."""
        s = self.structure
        merged = (s.merged,) if len(s.merged) else ()
        annotations = () if self.annotations is None else self.annotations.arrays()
        order = () if self.order is None else self.order.arrays
        attributes = (array for one in self.attributes for array in one.arrays)
        poses = (array for pose in self.poses for array in pose.arrays())
        further = (*order, *merged, *attributes, *annotations, *poses)
        return digest(s.faces, s.split_points, self.integers, further)

    def mesh(self, points: Floats, single: bool, margin: float = 0.0) -> PolyMesh:
        """Return the mesh.

        Parameters
        ----------
        points : float64 (p, 3)
            The decoded positions.
        single : bool
            Whether the source had them in float32.
        margin : float
            How far a writer may round each coordinate.
        """
        s = self.structure
        vertices = points[s.points] if s.has_split_vertices else points
        mesh = replace(
            assembled(vertices, s.faces, s.polygons if len(s.merged) else None),
            attributes=self._restored(vertices),
            precision="float32" if single else "float64",
            margin=margin,
        )
        mesh = mesh if self.annotations is None else self.annotations.given_to(mesh)
        if self.order is None:
            return mesh
        from deltamesh._order.reordering import reordered

        return reordered(mesh, self.order)

    def _restored(self, vertices: Floats) -> tuple[Attribute, ...]:
        if not self.attributes:
            return ()
        from deltamesh._attributes.section import restore_attribute

        return tuple(restore_attribute(one, self.domains, vertices) for one in self.attributes)


# The content before the first section.
NOTHING: Final = Content(Domains(EMPTY), Integers(NO_POINTS, NONE, NO_POINTS, NO_POINTS))


def digest(
    faces: Ints,
    split_points: Ints,
    integers: Integers,
    further: Iterable[Ints] = (),
) -> bytes:
    """Return the checksum of everything exact that a decoder makes (SPEC.md 5.7).

    Parameters
    ----------
    faces : int64 (m, 3)
        Triangles over vertices.
    split_points : int64 (n,) or (0,)
        The point of each vertex, where points are split into several vertices.
    integers : Integers
    further : iterable of int64 arrays
        Those of the order, the merged half-edges, those of the attributes, the text of the
        annotations and their arrays, those of the poses; each only where the file has it, in this
        order.

    Returns
    -------
    bytes, 8
    """
    i = integers
    all_of_them = (
        *(faces, split_points, i.values, i.anchors, i.positions, i.isolated, i.refinements),
        *(i.corrections, i.formats, i.exponents, i.units, i.cells, *further),
    )
    result = hashlib.blake2b(digest_size=8)
    for array in all_of_them:
        result.update(np.ascontiguousarray(array, dtype="<i8").data)
    return result.digest()
