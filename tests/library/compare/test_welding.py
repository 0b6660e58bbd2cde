"""Meshes as an encoder sees them: each position once, and no isolated vertex."""

from __future__ import annotations

import meshes
import numpy as np
import strategies
from hypothesis import given

from deltamesh._compare.welding import welded, without_isolated
from deltamesh._mesh import TriangleMesh


@given(strategies.complexes())
def test_each_position_is_there_once(mesh: meshes.Arrays) -> None:
    V, F = mesh
    found = welded(TriangleMesh(V, F))
    assert len(np.unique(found.vertices + 0.0, axis=0)) == len(found.vertices)
    np.testing.assert_array_equal(found.vertices[found.faces] + 0.0, V[F] + 0.0)


@given(strategies.complexes())
def test_no_vertex_is_without_a_face(mesh: meshes.Arrays) -> None:
    V, F = mesh
    found = without_isolated(TriangleMesh(V, F))
    assert set(found.faces.ravel().tolist()) == set(range(len(found.vertices)))
    np.testing.assert_array_equal(found.vertices[found.faces], V[F])


def test_zeros_of_both_signs_differ_on_demand() -> None:
    mesh = TriangleMesh(np.array([[0.0, 0, 0], [-0.0, 0, 0], [1, 0, 0]]), np.array([[0, 1, 2]]))
    assert len(welded(mesh).vertices) == 2
    assert len(welded(mesh, exact=True).vertices) == 3
