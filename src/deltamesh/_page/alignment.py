"""Alignment of an original with its decoded mesh, so that a page can show the differences."""

from __future__ import annotations

from dataclasses import replace

from deltamesh._compare.likeness import Correspondence
from deltamesh_formats.polymesh.mesh import PolyMesh
from deltamesh_formats.polymesh.permutations import inverse

# Roles of the attributes that a page can show.
_SHOWN = ("colour", "uv", "normal")


def aligned(mesh: PolyMesh, match: Correspondence) -> PolyMesh:
    """Return a mesh with the positions of its original, its vertices and faces as they are.

    Parameters
    ----------
    mesh : PolyMesh
        The second one of the correspondence.
    match : Correspondence
        Its first mesh is the original.
    """
    site = match.b.of_vertices
    known = site >= 0
    vertices = mesh.vertices.copy()
    vertices[known] = match.a.mesh.vertices[inverse(match.sites)[site[known]]]
    return shown(replace(mesh, vertices=vertices, margin=0.0))


def shown(mesh: PolyMesh) -> PolyMesh:
    """Return a mesh with the attributes alone that a page can show."""
    kept = tuple(one for one in mesh.attributes if one.role in _SHOWN)
    return replace(mesh, attributes=kept, metadata={}, lost=())
