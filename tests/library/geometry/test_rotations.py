"""Rotations of neighbourhoods: against their twins, and where neighbourhoods say little."""

from __future__ import annotations

import itertools
import math

import meshes
import numpy as np
import pytest
import rotations_oracle
from coders import neighbours_of

from deltamesh._geometry import rotations
from deltamesh._graph.adjacency import adjacency
from deltamesh._kernels.mesh import laplacian

MESHES = meshes.every()
ANGLES = [0, 30, 120, 180]
STRIP = np.array([[0, 1, 2], [1, 3, 2], [2, 3, 4]])
LINE = np.outer(np.arange(5.0), [1.0, 0, 0])
NOISE = 1e-9


def turn(axis: tuple[float, ...], degrees: float) -> np.ndarray:
    q = np.array([math.cos(math.radians(degrees) / 2), 0, 0, 0])
    q[1:] = math.sin(math.radians(degrees) / 2) * np.array(axis) / np.linalg.norm(axis)
    return rotations_oracle.matrix_of(q)


def bent(V: np.ndarray) -> np.ndarray:
    """Vertices turned about the z-axis, the further the higher they are."""
    x, y, z = V.T
    angle = 2 * z / (np.ptp(z) or 1)
    return np.stack(
        [x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), z], 1
    )


def with_noise(V: np.ndarray, seed: int) -> np.ndarray:
    extent = np.ptp(V, axis=0).max()
    return V + NOISE * extent * np.random.default_rng(seed).uniform(-1, 1, V.shape)


def amplified(graph: tuple[np.ndarray, np.ndarray], A: np.ndarray, B: np.ndarray) -> float:
    """How many times noise of vertices is found in turned deltas, at the most."""

    def turned(before: np.ndarray, after: np.ndarray) -> np.ndarray:
        return rotations.turned_deltas(graph, before, rotations.fit(graph, before, after))

    plain = turned(A, B)
    noisy = [turned(with_noise(A, seed), with_noise(B, seed + 9)) for seed in range(3)]
    return max(np.abs(one - plain).max() for one in noisy) / (NOISE * np.ptp(A, axis=0).max())


@pytest.mark.parametrize("rings", [0, 2])
@pytest.mark.parametrize("name", MESHES)
def test_rotations_equal_their_twin(name: str, rings: int) -> None:
    V, F = MESHES[name]
    graph, neighbours = adjacency(F, len(V)), neighbours_of(F, len(V))
    B = bent(V) @ turn((1, 2, 3), 100).T
    found = rotations.fit(graph, V, B, rings)
    np.testing.assert_allclose(found, rotations_oracle.fit(neighbours, V, B, rings), atol=1e-9)
    deltas = rotations.turned_deltas(graph, V, found)
    np.testing.assert_allclose(deltas, rotations_oracle.turned(neighbours, V, found), atol=1e-12)


@pytest.mark.parametrize("degrees", ANGLES)
@pytest.mark.parametrize("name", MESHES)
def test_a_turned_surface_is_followed_at_any_angle(name: str, degrees: int) -> None:
    V, F = MESHES[name]
    graph, R = adjacency(F, len(V)), turn((3, -1, 2), degrees)
    found = rotations.fit(graph, V, V @ R.T + 5)
    isolated = np.diff(graph[0]) == 0
    np.testing.assert_allclose(
        found[~isolated], np.broadcast_to(R, found[~isolated].shape), atol=1e-7
    )
    assert (found[isolated] == np.eye(3)).all()
    deltas = rotations.turned_deltas(graph, V, found)
    np.testing.assert_allclose(deltas, laplacian.apply(*graph, V) @ R.T, atol=1e-6)


def test_a_surface_that_has_not_moved_has_the_identity_to_the_bit() -> None:
    V, F = meshes.torus(9, 7)
    graph = adjacency(F, len(V))
    found = rotations.fit(graph, V, V)
    assert (found == np.eye(3)).all()


@pytest.mark.parametrize("name", MESHES)
def test_noise_is_not_amplified_on_surfaces(name: str) -> None:
    V, F = MESHES[name]
    graph = adjacency(F, len(V))
    for degrees in ANGLES:
        assert amplified(graph, V, V @ turn((1, 2, 3), degrees).T) < 30


LINES = {
    "still": LINE,
    "reversed": -LINE,
    "across": LINE[:, [1, 0, 2]],
    "away": LINE[:, [2, 1, 0]] * -1.0,
    "shifted": LINE + 3,
}


@pytest.mark.parametrize("name", LINES)
def test_vectors_along_one_line_go_where_the_line_goes(name: str) -> None:
    graph, B = adjacency(STRIP, 5), LINES[name]
    found = rotations.fit(graph, LINE, B)
    edges = LINE[1:] - LINE[:-1]
    np.testing.assert_allclose(edges @ found[2].T, B[1:] - B[:-1], atol=2e-3)
    assert amplified(graph, LINE, B) < 30


def test_across_a_line_that_stays_the_identity_is_kept() -> None:
    found = rotations.fit(adjacency(STRIP, 5), LINE, LINE)
    np.testing.assert_allclose(found, np.broadcast_to(np.eye(3), found.shape), atol=1e-12)


def test_a_reversed_line_has_no_rotation_across_it() -> None:
    found = rotations.fit(adjacency(STRIP, 5), LINE, -LINE)
    np.testing.assert_allclose(
        found, np.broadcast_to(np.diag([-1.0, 0, 0]), found.shape), atol=1e-12
    )


@pytest.mark.parametrize(("before", "after"), list(itertools.permutations([0.0, 1e-12, 1.0], 2)))
def test_where_nothing_is_known_there_is_the_identity(before: float, after: float) -> None:
    V, F = meshes.grid(4, 4)
    graph = adjacency(F, len(V))
    far = np.array([[9.0, 9, 9], [-9, -9, -9]])  # the extent is theirs
    A, B = (np.concatenate((V * scale, far)) for scale in (before, after))
    B = B @ turn((1, 1, 0), 90).T
    graph = np.concatenate((graph[0], graph[0][-1:], graph[0][-1:])), graph[1]
    found = rotations.fit(graph, A, B)
    np.testing.assert_allclose(found, np.broadcast_to(np.eye(3), found.shape), atol=1e-4)
    assert amplified(graph, A, B) < 1000


def test_noise_is_bounded_where_neighbourhoods_collapse_or_mirror() -> None:
    rng, graph = np.random.default_rng(1), adjacency(np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]]), 5)
    for _ in range(500):
        thin = 10.0 ** rng.uniform(-9, 0, 3)
        A = rng.normal(size=(5, 3)) * [1, thin[0], thin[0] * thin[1]]
        B = A @ turn(tuple(rng.normal(size=3)), rng.choice([0, 180, rng.uniform(0, 180)])).T
        if rng.random() < 0.3:
            B = B * [1, 1, -1]
        if rng.random() < 0.3:
            B[:4] *= thin[2]
        assert amplified(graph, A, B) < rotations_oracle.POWER * 10


def test_nearest_rotations_are_those_of_singular_values() -> None:
    rng = np.random.default_rng(5)
    matrices = np.array([turn(tuple(rng.normal(size=3)), rng.uniform(0, 180)) for _ in range(50)])
    matrices = matrices @ (np.eye(3) + 0.2 * rng.normal(size=(50, 3, 3)))
    found = rotations.nearest(matrices)
    np.testing.assert_allclose(found, [rotations_oracle.nearest(M) for M in matrices], atol=1e-9)
    np.testing.assert_allclose(found, [rotations_oracle.kabsch(M) for M in matrices], atol=1e-7)
    np.testing.assert_allclose(found @ found.swapaxes(1, 2), [np.eye(3)] * 50, atol=1e-12)


def test_a_line_of_a_matrix_goes_where_it_goes() -> None:
    found = rotations.nearest(np.zeros((2, 3, 3)))
    np.testing.assert_allclose(found, [np.eye(3)] * 2, atol=1e-12)
    halfway = np.diag([0.0, 0, 1])  # between the identity and half a turn about z
    np.testing.assert_allclose(
        rotations.nearest(halfway[None])[0] @ [0, 0, 1], [0, 0, 1], atol=1e-9
    )


def test_sums_are_in_the_order_of_the_neighbours() -> None:
    V, F = meshes.torus(9, 7)
    (indptr, indices), R = (
        adjacency(F, len(V)),
        np.random.default_rng(2).normal(size=(len(V), 3, 3)),
    )
    wanted = np.zeros_like(V)
    for i, (begin, end) in enumerate(itertools.pairwise(indptr)):
        for j in indices[begin:end]:
            (p, q, r), (x, y, z) = R[i] + R[j], V[i] - V[j]
            wanted[i] += [0.5 * (a * x + b * y + c * z) for a, b, c in (p, q, r)]
    assert rotations.turned_deltas((indptr, indices), V, R).tobytes() == wanted.tobytes()


def test_nothing_is_turned_without_vertices() -> None:
    graph, none = adjacency(np.zeros((0, 3), dtype=np.int64), 0), np.zeros((0, 3))
    assert rotations.fit(graph, none, none).shape == (0, 3, 3)
    assert rotations.nearest(np.zeros((0, 3, 3))).shape == (0, 3, 3)
    assert rotations.turned_deltas(graph, none, np.zeros((0, 3, 3))).shape == (0, 3)
