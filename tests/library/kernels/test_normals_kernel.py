"""Normals of vertices, against a loop over the faces."""

from __future__ import annotations

import math

import meshes
import numpy as np
import oracle
import pytest

from deltamesh._geometry.normals import FADE, MOST_STEP
from deltamesh._kernels.mesh import normals

MESHES = meshes.every()


def found(V: np.ndarray, F: np.ndarray, steps: np.ndarray) -> np.ndarray:
    return normals.vertex_normals(V, F, steps, MOST_STEP, FADE)


@pytest.mark.parametrize("name", MESHES)
def test_normals_equal_their_twin(name: str) -> None:
    V, F = MESHES[name]
    np.testing.assert_allclose(found(V, F, np.array([0.1])), oracle.normals(V, F, 0.1), atol=1e-12)
    each = np.random.default_rng(3).uniform(0.01, 1, len(V))
    np.testing.assert_allclose(found(V, F, each), oracle.normals(V, F, each), atol=1e-12)


def test_sums_are_in_the_order_of_the_faces() -> None:
    V, F = meshes.torus(9, 7)
    V = V / np.ptp(V, axis=0).max()
    assert np.ptp(V, axis=0).max() == 1
    sums, areas = np.zeros((len(V), 3)), np.zeros(len(V))
    for face in F:
        (a, b, c), (x, y, z) = V[face[1]] - V[face[0]], V[face[2]] - V[face[0]]
        normal = np.array([b * z - c * y, c * x - a * z, a * y - b * x])
        for v in face:
            sums[v] += normal
            areas[v] += math.sqrt(normal[0] ** 2 + normal[1] ** 2 + normal[2] ** 2)
    lengths = np.sqrt(sums[:, 0] ** 2 + sums[:, 1] ** 2 + sums[:, 2] ** 2)
    wanted = sums / (lengths + FADE * (areas + 0.25))[:, None]
    assert found(V, F, np.array([0.5])).tobytes() == wanted.tobytes()


def test_normals_are_the_same_far_from_the_origin() -> None:
    V, F = meshes.icosphere(2)
    V = np.round(V * 2**20) / 2**20
    step = np.array([0.01])
    assert found(V + 2.0**30, F, step).tobytes() == found(V, F, step).tobytes()


def test_a_step_counts_as_so_many_extents_at_most() -> None:
    V, F = meshes.icosphere(1)
    V = V / np.ptp(V, axis=0).max()
    steps = np.where(np.arange(len(V)) % 2, 5.0, np.inf)
    wanted = found(V, F, np.array([5.0]))
    assert normals.vertex_normals(V, F, steps, 5.0, FADE).tobytes() == wanted.tobytes()


def test_points_without_an_extent_have_no_normals() -> None:
    V, F = np.full((3, 3), 7.0), np.array([[0, 1, 2]])
    assert not found(V, F, np.array([1.0])).any()
    assert found(np.zeros((0, 3)), F[:0], np.array([1.0])).shape == (0, 3)


@pytest.mark.parametrize("bad", [-1, 4, 1 << 62])
def test_indices_of_no_vertex_are_refused(bad: int) -> None:
    with pytest.raises(ValueError, match="contradict"):
        found(np.zeros((4, 3)), np.array([[0, 1, bad]]), np.array([1.0]))


@pytest.mark.parametrize("count", [0, 2, 5])
def test_steps_of_another_number_of_vertices_are_refused(count: int) -> None:
    with pytest.raises(ValueError, match="contradict"):
        found(np.zeros((4, 3)), np.array([[0, 1, 2]]), np.ones(count))
