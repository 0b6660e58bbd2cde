"""Everything exact in a file, as encoder and decoder know it, and the mesh that it is."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from deltamesh._attributes.domains import Domains
from deltamesh._attributes.section import CodedAttribute, attribute_arrays, restore_attribute
from deltamesh._geometry.integers import Integers
from deltamesh._order.reordering import Order, order_arrays, reordered
from deltamesh._parts import Annotations
from deltamesh._shape.polygons import assembled
from deltamesh._shape.structure import Structure
from deltamesh_formats.polymesh.mesh import PolyMesh


@dataclass(frozen=True)
class Content:
    """What is in a file beside its parameters.

    Attributes
    ----------
    structure : Structure
    integers : Integers
        Of the geometry.
    attributes : tuple of CodedAttribute
    told : Annotations or None
        Parts, names, metadata.
    order : Order or None
        None where it is free.
    """

    structure: Structure
    integers: Integers
    attributes: tuple[CodedAttribute, ...] = ()
    told: Annotations | None = None
    order: Order | None = None

    @cached_property
    def places(self) -> Domains:
        """What attributes and parts belong to."""
        return Domains(self.structure)

    def digest(self) -> bytes:
        """Return the checksum that CHEK has of it (SPEC.md 5.7)."""
        s, told = self.structure, () if self.told is None else self.told.arrays()
        further = (*order_arrays(self.order), *s.glue, *attribute_arrays(self.attributes), *told)
        return digest(s.faces, s.copied, self.integers, further)

    def mesh(self, points: NDArray[np.float64], single: bool) -> PolyMesh:
        """Return the mesh.

        Parameters
        ----------
        points : float64 (p, 3)
            The decoded positions.
        single : bool
            Whether the source had them in float32.
        """
        V, s = points[self.structure.points], self.structure
        mesh = replace(
            assembled(V, s.faces, s.polygons),
            attributes=tuple(restore_attribute(one, self.places, V) for one in self.attributes),
            precision="float32" if single else "float64",
        )
        mesh = mesh if self.told is None else self.told.given_to(mesh)
        return mesh if self.order is None else reordered(mesh, self.order)


def digest(
    faces: NDArray[np.int64],
    copied: NDArray[np.int64],
    integers: Integers,
    order: Iterable[NDArray[np.int64]] = (),
) -> bytes:
    """Return the checksum of everything exact that a decoder makes (SPEC.md 5.7).

    Parameters
    ----------
    faces : int64 (m, 3)
    copied : int64 (n,) or (0,)
        The point of each vertex, where some have several.
    integers : Integers
    order : int64 arrays
        Of vertices, faces and corners, where it is kept.
    """
    i = integers
    arrays = (
        *(faces, copied, i.values, i.anchors, i.positions, i.isolated, i.refinements),
        *(i.corrections, i.formats, *order),
    )
    result = hashlib.blake2b(digest_size=8)
    for array in arrays:
        result.update(np.ascontiguousarray(array, dtype="<i8").data)
    return result.digest()
