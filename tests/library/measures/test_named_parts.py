"""Names of parts: those of objects, numbers of components, or both."""

from __future__ import annotations

import dataclasses

import meshes
import numpy as np

from deltamesh._graph.adjacency import components_of_faces
from deltamesh._measures.named_parts import named_parts
from deltamesh_formats.polymesh.mesh import Parts, from_triangles


def names(V, F, *divisions, order=None):
    mesh = dataclasses.replace(from_triangles(V, F), parts=divisions)
    polygons = np.arange(len(F)) if order is None else order
    named = named_parts(mesh, F[polygons], polygons, components_of_faces(F, len(V)))
    return [named.name(i) for i in range(named.parts.count)]


V, F = meshes.union(meshes.tetrahedron(), meshes.grid(3, 3), meshes.tetrahedron())
OF_FACE = np.repeat([0, 1, 2], [4, 8, 4])


def test_components_have_numbers_in_the_order_of_their_first_faces():
    assert names(V, F) == ["component 0", "component 1", "component 2"]
    backwards = np.arange(len(F))[::-1]
    assert names(V, F, order=backwards) == ["component 0", "component 1", "component 2"]


def test_objects_of_one_component_lend_it_their_name():
    parts = Parts("object", ("ball", "", "other ball"), OF_FACE)
    assert names(V, F, parts) == ["ball", "component 1", "other ball"]


def test_components_of_one_object_have_its_name_and_a_number():
    parts = Parts("object", ("hall",), np.minimum(OF_FACE, 0))
    assert names(V, F, parts) == [f"component {i} of hall" for i in range(3)]


def test_groups_and_materials_are_no_objects():
    assert names(V, F, Parts("material", ("a", "b", "c"), OF_FACE))[0] == "component 0"


def test_objects_within_a_component_have_their_names():
    halves = np.where(OF_FACE == 1, np.arange(len(F)) % 2, -1)
    parts = Parts("mesh", ("even", "odd"), halves)
    assert names(V, F, parts) == ["component 0", "component 1", "component 2", "even", "odd"]
