"""Everything exact in a file, as encoder and decoder know it, and the mesh that it is."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from deltamesh.attributes.coded import Coded, all_arrays, restored
from deltamesh.attributes.places import Places
from deltamesh.geometry.surface import Integers, digest
from deltamesh.parts import Told
from deltamesh.reordering import Order, arrays, reordered
from deltamesh.shape.polygons import assembled
from deltamesh.shape.structure import Structure
from deltamesh_formats.polymesh import PolyMesh


@dataclass(frozen=True)
class Content:
    """What is in a file beside its parameters.

    Attributes
    ----------
    structure : Structure
    integers : Integers
        Of the geometry.
    attributes : tuple of Coded
    told : Told or None
        Parts, names, metadata.
    order : Order or None
        None where it is free.
    """

    structure: Structure
    integers: Integers
    attributes: tuple[Coded, ...] = ()
    told: Told | None = None
    order: Order | None = None

    @cached_property
    def places(self) -> Places:
        """What attributes and parts belong to."""
        return Places(self.structure)

    def digest(self) -> bytes:
        """Return the checksum that CHEK has of it (SPEC.md 5.7)."""
        s, told = self.structure, () if self.told is None else self.told.arrays()
        further = (*arrays(self.order), *s.glue, *all_arrays(self.attributes), *told)
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
            attributes=tuple(restored(one, self.places, V) for one in self.attributes),
            precision="float32" if single else "float64",
        )
        mesh = mesh if self.told is None else self.told.given_to(mesh)
        return mesh if self.order is None else reordered(mesh, self.order)
