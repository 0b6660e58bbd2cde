"""Structures: what follows from each step from a manifold to polygons."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import strategies
from drafts import stages_of
from hypothesis import given
from polygon_meshes import MADE, quad_torus

from deltamesh._graph.elements import of_vertices
from deltamesh._graph.laplacian import laplacian
from deltamesh._shape.structure import EMPTY, Structure
from deltamesh_formats.polymesh.mesh import PolyMesh, from_triangles


def structure_of_mesh(mesh: PolyMesh) -> Structure:
    return list(stages_of(mesh).values())[-1].after.structure


def assert_same_elements(one, other) -> None:
    assert one.count == other.count
    for name in ("indptr", "indices", "first", "corners", "within"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_the_structure_before_the_first_section_is_empty() -> None:
    assert EMPTY.faces.shape == (0, 3)
    assert EMPTY.complex.point_count == len(EMPTY.points) == 0
    assert not EMPTY.has_split_vertices
    assert len(EMPTY.polygons.offsets) == 1


@given(strategies.complexes())
def test_points_of_vertices_make_the_faces_of_the_complex(mesh: meshes.Arrays) -> None:
    s = structure_of_mesh(from_triangles(*mesh))
    np.testing.assert_array_equal(s.points[s.faces], s.complex.faces)
    assert (np.diff(s.points) >= 0).all()
    assert s.has_split_vertices == (len(s.points) > s.complex.point_count)
    assert s.split_points.tolist() == (s.points.tolist() if s.has_split_vertices else [])
    assert len(s.complex.manifold_faces) == len(s.complex.manifold.faces) <= len(s.faces)
    assert s.complex.manifold_faces.max(initial=-1) + 1 == s.complex.used


@given(strategies.complexes())
def test_vertices_have_the_neighbours_of_all_triangles(mesh: meshes.Arrays) -> None:
    """However they are found: with the half-edges of a manifold, or without."""
    s = structure_of_mesh(from_triangles(*mesh))
    assert_same_elements(s.vertices, of_vertices(s.faces, len(s.points)))


def test_a_surface_of_quads_has_the_edges_of_quads() -> None:
    s = structure_of_mesh(quad_torus(6, 5))
    surface = s.surface
    assert surface.quads.shape == (30, 4)
    assert (np.diff(surface.graph[0]) == 4).all()
    assert np.diff(s.vertices.indptr).max() > 4  # diagonals are edges of its triangles
    plain = structure_of_mesh(from_triangles(*meshes.torus(6, 5))).surface
    dense = oracle.laplacian(plain.faces, 30)
    np.testing.assert_array_equal(laplacian(*plain.graph).toarray(), dense)


def test_isolated_vertices_come_last_and_predict_nothing() -> None:
    s = structure_of_mesh(from_triangles(*meshes.with_isolated()))
    assert (s.complex.used, s.complex.isolated) == (42, 4)
    assert s.surface.vertex_count == 42
    assert s.surface.elements.count == 46
    assert (np.diff(s.surface.elements.indptr)[42:] == 0).all()
    assert s.surface.elements.corners.max() < 42


def test_merge_candidates_of_merged_halfedges_are_edges_within_polygons() -> None:
    s = structure_of_mesh(MADE["prism"])
    merged = np.flatnonzero(s.merged >= 0)
    assert len(merged) == 2 * (len(s.faces) - len(MADE["prism"].sizes))
    np.testing.assert_array_equal(s.merge_candidates[merged], s.merged[merged])
    assert sorted(np.diff(s.polygons.offsets)) == sorted(MADE["prism"].sizes)
