"""Removal of attributes, parts and metadata from a mesh by their names."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import Final

from deltamesh_formats.polymesh.mesh import PolyMesh

# Names of everything that can be dropped, and of the transforms of parts.
EVERYTHING: Final = "all"
TRANSFORMS: Final = "transforms"


def without(mesh: PolyMesh, names: Collection[str]) -> PolyMesh:
    """Return a mesh without what has one of these names, but with all vertices and faces.

    Parameters
    ----------
    mesh : PolyMesh
    names : collection of str
        Names or roles of attributes ("uv" is every set of texture coordinates, "uv1" the second
        one), kinds of parts ("group"), keys of metadata ("comments"), "transforms", "all". Names
        that the mesh does not have are ignored: one list may serve many meshes.
    """
    if EVERYTHING in names:
        return replace(mesh, attributes=(), parts=(), metadata={})
    attributes = (a for a in mesh.attributes if a.name not in names and a.role not in names)
    parts = (p for p in mesh.parts if p.kind not in names)
    if TRANSFORMS in names:
        parts = (replace(p, transforms=None) for p in parts)
    metadata = {key: lines for key, lines in mesh.metadata.items() if key not in names}
    return replace(mesh, attributes=tuple(attributes), parts=tuple(parts), metadata=metadata)
