"""Meshes in a pose: normals turn with their vertices, corners and faces, and nothing else does."""

from __future__ import annotations

import numpy as np
import pytest
from bars import turn

from deltamesh._attributes.turned import posed_mesh
from deltamesh_formats.polymesh.arrays import from_arrays
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh

QUARTER = turn((0, 0, 1), 90)
V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [5, 5, 5]])
FACES = [[0, 1, 2], [0, 2, 3]]
TURNS = np.array([QUARTER, QUARTER, QUARTER, np.eye(3), np.eye(3)])


def with_normals(domain: str, normals: np.ndarray, index: np.ndarray | None = None) -> PolyMesh:
    mesh = from_arrays(V, FACES, vertex={"uv": V[:, :2], "heat": V})
    one = Attribute("normal", domain, normals, "normal", index)
    return PolyMesh(V, mesh.corners, mesh.offsets, (*mesh.attributes, one))


def turned(mesh: PolyMesh) -> PolyMesh:
    return posed_mesh(mesh, V + 1, TURNS)


def test_positions_change_and_other_attributes_stay() -> None:
    mesh = with_normals("vertex", np.tile([1.0, 0, 0], (5, 1)))
    found = turned(mesh)
    np.testing.assert_array_equal(found.vertices, V + 1)
    assert found.attributes[:2] == mesh.attributes[:2]
    np.testing.assert_array_equal(mesh.attributes[2].values, np.tile([1.0, 0, 0], (5, 1)))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_normals_of_vertices_turn(dtype: type) -> None:
    found = turned(with_normals("vertex", np.tile([2, 0, 0], (5, 1)).astype(dtype)))
    wanted = [[0, 2, 0]] * 3 + [[2, 0, 0]] * 2
    np.testing.assert_allclose(found.attributes[2].values, wanted, atol=1e-6)
    assert found.attributes[2].values.dtype == dtype


def test_normals_of_corners_turn_by_their_vertices() -> None:
    found = turned(with_normals("corner", np.tile([1.0, 0, 0], (6, 1))))
    wanted = [[0, 1, 0]] * 5 + [[1, 0, 0]]
    np.testing.assert_allclose(found.attributes[2].values, wanted, atol=1e-12)


def test_normals_of_faces_turn_by_the_mean_and_keep_their_lengths() -> None:
    found = turned(with_normals("face", np.array([[1.0, 0, 0], [3, 0, 0]])))
    values = found.attributes[2].values
    np.testing.assert_allclose(values[0], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(values[1], np.array([1, 2, 0]) * 3 / np.sqrt(5), atol=1e-12)


def test_a_row_that_several_share_becomes_several() -> None:
    index = np.array([0, 0, -1, 0, 0])
    found = turned(with_normals("vertex", np.array([[1.0, 0, 0]]), index)).attributes[2]
    np.testing.assert_array_equal(found.rows() < 0, index < 0)
    has = index >= 0
    wanted = np.array([[0, 1, 0], [0, 1, 0], [0, 0, 0], [1, 0, 0], [1, 0, 0]])
    np.testing.assert_allclose(found.values[found.rows()[has]], wanted[has], atol=1e-12)


def test_what_has_no_direction_stays() -> None:
    odd = np.array([[0.0, 0, 0], [np.nan, 0, 0], [np.inf, 0, 0], [1, 0, 0], [1, 0, 0]])
    found = turned(with_normals("vertex", odd)).attributes[2]
    np.testing.assert_array_equal(found.values, odd)
