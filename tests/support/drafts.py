"""Structures of meshes, as the encoder makes them section by section."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import ModuleType

import numpy as np
from containers import CARTESIAN

from deltamesh._shape import connectivity, merging, split_vertices, stitches
from deltamesh._shape.diagonals import cut_polygons
from deltamesh._shape.draft import ShapeDraft, first_draft
from deltamesh._shape.merge_candidates import merged_halfedges
from deltamesh._shape.structure import Structure
from deltamesh_formats.container.building import build_container
from deltamesh_formats.container.container import Container
from deltamesh_formats.polymesh.mesh import PolyMesh

SECTIONS = {"CONN": connectivity, "STCH": stitches, "COPY": split_vertices, "POLY": merging}


def before_polygons(mesh: PolyMesh) -> ShapeDraft:
    stages = stages_of(mesh)
    return stages["POLY"].before if "POLY" in stages else list(stages.values())[-1].after


def merged_of(mesh):
    """The structure without its polygons, and the merged half-edges."""
    draft = before_polygons(mesh)
    corners = draft.triangle_provenance.corners
    return draft.structure, merged_halfedges(draft.input.triangles, corners)


@dataclass(frozen=True)
class Stage:
    """A section of a structure: its payload, and the draft before it and after it."""

    section: ModuleType
    payload: bytes
    before: ShapeDraft
    after: ShapeDraft


def stages_of(mesh: PolyMesh, *, drop_isolated: bool = False) -> dict[str, Stage]:
    """The sections that the structure of a mesh has, by the id of each, in their order."""
    draft = first_draft(mesh.vertices, cut_polygons(mesh), drop_isolated=drop_isolated, exact=False)
    found = {}
    for name, section in SECTIONS.items():
        if section.applies(draft):
            payload, after = section.encode(draft)
            found[name] = Stage(section, payload, draft, after)
            draft = after
    return found


def container_of(stages: dict[str, Stage]) -> Container:
    """A file of these sections, whose geometry nobody reads."""
    structure = list(stages.values())[-1].after.structure
    parameters = replace(CARTESIAN, isolated=structure.complex.isolated)
    payloads = {name: stage.payload for name, stage in stages.items()} | {"CART": b""}
    counts = len(structure.points), len(structure.faces)
    return build_container(*counts, parameters, payloads, None, bytes(8))


def assert_same_structure(one: Structure, other: Structure) -> None:
    for name in ("faces", "points", "merged"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))
    built, again = one.complex, other.complex
    assert (built.used, built.isolated) == (again.used, again.isolated)
    np.testing.assert_array_equal(built.manifold.faces, again.manifold.faces)
    np.testing.assert_array_equal(built.manifold.opposite, again.manifold.opposite)
    for name in ("points", "reversed", "repeated", "against", "degenerate"):
        np.testing.assert_array_equal(getattr(built.stitches, name), getattr(again.stitches, name))
