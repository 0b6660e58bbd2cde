"""Parts of a mesh with names, for people."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np

from deltamesh._measures.parts import Parts, parts_of
from deltamesh_formats.array_types import Ints
from deltamesh_formats.polymesh import mesh as polymesh
from deltamesh_formats.polymesh.kinds import Kind

# The kinds of parts of a file that are measured as parts.
OBJECTS: Final[tuple[Kind, ...]] = ("object", "mesh")


@dataclass(frozen=True)
class NamedParts:
    """Parts of a mesh, and what their names follow from.

    Attributes
    ----------
    parts : Parts
    polygons : int64 (m,)
        The polygon of the mesh at each face.
    divisions : tuple of polymesh.Parts
        Of the mesh, into objects.
    """

    parts: Parts
    polygons: Ints
    divisions: tuple[polymesh.Parts, ...]

    def name(self, index: int) -> str:
        """Return the name of a part: that of its object, or "component 3", or both.

        Components are numbered from 0 in the order of their first polygons.
        """
        faces = next(part for part in self.parts.divisions if (part == index).any()) == index
        title = f"component {self._ordinal(index)}" if index < self.parts.components else ""
        for division in self.divisions:
            owner = division.of_face[self.polygons]
            found = int(owner[faces][0])
            if found < 0 or (owner[faces] != found).any() or not division.names[found]:
                continue
            name = division.names[found]
            alone = not title or np.array_equal(owner == found, faces)
            return name if alone else f"{title} of {name}"
        return title or "an object without a name"

    def _ordinal(self, index: int) -> int:
        """Return how many components begin before a component."""
        of_face = self.parts.divisions[0]
        first = np.full(self.parts.components, np.iinfo(np.int64).max)
        np.minimum.at(first, of_face, self.polygons)
        return int((first < first[index]).sum())


def named_parts(mesh: polymesh.PolyMesh, F: Ints, polygons: Ints, component: Ints) -> NamedParts:
    """Return the parts of a mesh: its components, and the objects that are not made of whole ones.

    Parameters
    ----------
    mesh : PolyMesh
    F : int64 (m, 3)
        Its faces as they are measured.
    polygons : int64 (m,)
        The polygon of the mesh at each.
    component : int64 (n,)
        The component of each vertex of the faces, -1 for one in none.
    """
    divisions = tuple(parts for parts in mesh.parts if parts.kind in OBJECTS)
    parts = parts_of(F, component, [one.of_face[polygons] for one in divisions])
    return NamedParts(parts, polygons, divisions)
