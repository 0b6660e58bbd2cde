"""Domains of attributes: the vertices, corners and polygons of a structure."""

from __future__ import annotations

import numpy as np
from drafts import stages_of
from hypothesis import given
from polygon_meshes import lists_of, quad_torus, soups

from deltamesh._attributes.domains import Domains
from deltamesh._shape.polygons import assembled
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import PolyMesh


def domains_of(mesh: PolyMesh) -> Domains:
    return Domains(list(stages_of(mesh).values())[-1].after.structure)


@given(soups())
def test_corners_lead_to_their_vertices_and_polygons(mesh: PolyMesh) -> None:
    domains = domains_of(mesh)
    counts = [domains.count(domain) for domain in ("vertex", "corner", "face")]
    assert counts == [len(mesh.vertices), len(mesh.corners), len(mesh.sizes)]
    s = domains.structure
    built = assembled(np.zeros((len(s.points), 3)), s.faces, domains.polygons)
    np.testing.assert_array_equal(domains.vertex_of_corners, built.corners)
    owner = [i for i, polygon in enumerate(lists_of(built)) for _ in polygon]
    assert domains.polygon_of_corners.tolist() == owner
    assert domains.vertices.count == counts[0]
    assert domains.faces.count == counts[2]


def test_degenerate_polygons_have_vertices_and_faces_as_elements() -> None:
    mesh = from_arrays(np.eye(10, 3), [[2, 0, 0, 1], [1, 2, 0, 0]])
    domains = domains_of(mesh)
    assert (domains.vertices.count, domains.faces.count) == (10, 2)


def test_quads_are_neighbours_of_quads() -> None:
    domains = domains_of(quad_torus(6, 5))
    assert (np.diff(domains.faces.indptr) == 4).all()
    assert len(domains.faces.corners) == 0
