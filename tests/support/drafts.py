"""Structures of meshes, as the encoder makes them section by section."""

from __future__ import annotations

from deltamesh._shape import connectivity, split_vertices, stitches
from deltamesh._shape.diagonals import cut_polygons
from deltamesh._shape.draft import ShapeDraft, first_draft
from deltamesh._shape.merge_candidates import merged_halfedges
from deltamesh_formats.polymesh.mesh import PolyMesh


def before_polygons(mesh: PolyMesh) -> ShapeDraft:
    draft = first_draft(mesh.vertices, cut_polygons(mesh), drop_isolated=False, exact=False)
    for section in (connectivity, stitches, split_vertices):
        if section.applies(draft):
            _, draft = section.encode(draft)
    return draft


def merged_of(mesh):
    """The structure without its polygons, and the merged half-edges."""
    draft = before_polygons(mesh)
    corners = draft.triangle_provenance.corners
    return draft.structure, merged_halfedges(draft.input.triangles, corners)
