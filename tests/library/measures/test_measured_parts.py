"""Errors of parts, against those of each part alone."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._graph.adjacency import components_of_faces
from deltamesh._measures.measure import Measure
from deltamesh._measures.metrics import diagonal, rounded_up, vertex_errors
from deltamesh._measures.parts import PartErrors, parts_of


@pytest.fixture
def rng():
    return np.random.default_rng(2006)


def scene():
    """Three components of unlike size, and an isolated vertex in the middle."""
    V, F = meshes.union(meshes.grid(9, 7), meshes.icosphere(1), meshes.torus(8, 6))
    V[63:105] *= 0.01
    V = np.insert(V, 63, [3.0, 3, 3], axis=0)
    return V, np.where(F >= 63, F + 1, F)


def moved(V, rng, size=0.003):
    return V + size * rng.normal(size=V.shape)


def alone(V, W, F):
    """Errors of faces and their vertices, as if they were a mesh."""
    used, faces = np.unique(F, return_inverse=True)
    return rounded_up(vertex_errors(V[used], W[used], faces.reshape(F.shape)))


def assert_equal_errors(found, i, V, W, F):
    expected = alone(V, W, F)
    for name in ("rms", "max", "normal_deviation", "dihedral"):
        assert getattr(found, name)[i] == pytest.approx(getattr(expected, name), rel=1e-6), name
    assert found.diagonal[i] == pytest.approx(diagonal(V[np.unique(F)]))


def test_components_are_measured_as_if_they_were_alone(rng):
    V, F = scene()
    W = moved(V, rng)
    component = components_of_faces(F, len(V))
    assert component[63] == -1
    parts = parts_of(F, component)
    found = Measure(V, F, parts)(W).parts
    assert parts.count == parts.components == 3
    for i in range(3):
        assert_equal_errors(found, i, V, W, F[component[F[:, 0]] == i])


def test_objects_within_components_are_parts_too(rng):
    V, F = scene()
    W = moved(V, rng)
    component = components_of_faces(F, len(V))
    objects = np.where(component[F[:, 0]] == 0, np.arange(len(F)) % 2, 2)
    objects[5] = -1
    parts = parts_of(F, component, [objects])
    # Object 2 is two whole components, whose errors bound its own.
    assert (parts.components, parts.count) == (3, 5)
    found = Measure(V, F, parts)(W).parts
    for i in range(2):
        faces = F[objects == i]
        expected = alone(V, W, faces)
        assert found.rms[3 + i] == pytest.approx(expected.rms)
        assert found.normal_deviation[3 + i] == pytest.approx(expected.normal_deviation, rel=1e-6)


def test_one_part_needs_no_parts(rng):
    V, F = meshes.torus(8, 6)
    parts = parts_of(F, np.zeros(len(V), dtype=np.int64), [np.full(len(F), 7)])
    assert parts.count == 1
    measure = Measure(V, F, parts)
    assert measure(moved(V, rng)).parts is None
    assert measure.diagonals == pytest.approx([diagonal(V)])


def test_a_line_has_no_normals_to_keep(rng):
    V, F = meshes.union(meshes.icosphere(1), meshes.tetrahedron())
    V[42:] = [[0.0, 0, 0], [1, 0, 0], [2, 1e-9, 0], [3, 0, 1e-9]]
    W = moved(V, rng)
    found = Measure(V, F, parts_of(F, components_of_faces(F, len(V))))(W).parts
    assert found.normal_deviation[0] > 0
    assert found.normal_deviation[1] == 0
    assert found.rms[1] > 0


def test_the_worst_part_is_that_of_the_largest_share():
    one, zero = np.ones(3), np.zeros(3)
    errors = PartErrors(
        rms=np.array([0.001, 0.004, 0.0]),
        max=one,
        normal_deviation=np.array([0.5, 0.0, 2.0]),
        dihedral=zero,
        diagonal=one,
    )
    assert errors.worst == 1


def test_faces_that_lose_their_area_or_turn_over_are_told():
    V = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0], [2, 0, 0], [3, 0, 0]])
    F = np.array([[0, 1, 2], [0, 2, 3], [1, 4, 2], [4, 5, 6]])
    W = V.copy()
    W[1] = [0, 0, 0]  # the first face becomes a line
    W[3] = [1, 0.5, 0]  # the second one turns over
    measured = Measure(V, F, parts_of(F, components_of_faces(F, len(V))))(W)
    assert measured.lost.tolist() == [True, False, False, False]
    assert measured.turned.tolist() == [False, True, False, False]
