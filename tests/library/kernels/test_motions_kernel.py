"""Trees of anchors, and their motions: against sets, and against matrices."""

from __future__ import annotations

import motions_oracle
import numpy as np
import pytest
from rotations_oracle import matrix_of

from deltamesh._graph.adjacency import adjacency_between
from deltamesh._kernels.mesh import motions

RNG = np.random.default_rng(11)


def random_tree(n: int) -> tuple[np.ndarray, np.ndarray]:
    """Neighbours of nodes in two trees or more, of any shapes."""
    a = np.arange(2, n)
    b = np.array([RNG.integers(v) for v in a], dtype=np.int64)
    names = RNG.permutation(n)
    return adjacency_between(names[a], names[b], n)


@pytest.mark.parametrize("n", [2, 3, 10, 60])
def test_a_forest_is_that_of_sets(n: int) -> None:
    for count in (0, n - 1, 3 * n):
        edges = RNG.integers(n, size=(count, 2))
        a, b = np.ascontiguousarray(edges.T)
        assert motions.span(a, b, n).tolist() == motions_oracle.span(edges.tolist(), n)


@pytest.mark.parametrize("n", [0, 1, 2, 3, 50])
def test_trees_are_walked_breadth_first(n: int) -> None:
    if n < 2:
        graph = np.zeros(n + 1, dtype=np.int32), np.zeros(0, dtype=np.int32)
    else:
        graph = random_tree(n)
    order, parent = motions.walk(*graph)
    neighbours = [graph[1][graph[0][v] : graph[0][v + 1]].tolist() for v in range(n)]
    assert (order.tolist(), parent.tolist()) == motions_oracle.walk(neighbours)


@pytest.mark.parametrize("spread", [0, 3, 3000])
def test_motions_are_those_of_matrices(spread: int) -> None:
    order, parent = motions.walk(*random_tree(40))
    rest = RNG.normal(size=(40, 3))
    numbers = RNG.integers(-spread, spread + 1, size=(40, 6))
    positions, quaternions = motions.carry(order, parent, rest, 0.01, 2.0**-10, numbers)
    wanted, turns = motions_oracle.carry(order, parent, rest, 0.01, 2.0**-10, numbers)
    np.testing.assert_allclose(positions, wanted, atol=1e-10)
    np.testing.assert_allclose([matrix_of(q) for q in quaternions], turns, atol=1e-11)
    np.testing.assert_allclose(np.linalg.norm(quaternions, axis=1), 1, atol=1e-12)


def test_what_is_measured_comes_back_within_half_a_step() -> None:
    order, parent = motions.walk(*random_tree(40))
    rest, positions = RNG.normal(size=(2, 40, 3))
    quaternions = RNG.normal(size=(40, 4))
    quaternions /= np.linalg.norm(quaternions, axis=1, keepdims=True)
    numbers = motions.measure(order, parent, rest, 1e-3, 2.0**-10, positions, quaternions)
    found, turned = motions.carry(order, parent, rest, 1e-3, 2.0**-10, numbers)
    assert np.abs(found - positions).max() <= 0.5e-3 + 1e-12
    angles = 2 * np.arccos(np.minimum(np.abs((turned * quaternions).sum(axis=1)), 1))
    assert angles.max() < 4 * np.sqrt(3) / 2 * 2.0**-10
    again = motions.measure(order, parent, rest, 1e-3, 2.0**-10, found, turned)
    np.testing.assert_array_equal(again, numbers)


def test_a_body_that_moves_as_one_has_numbers_at_the_root_alone() -> None:
    order, parent = motions.walk(*random_tree(30))
    rest = RNG.normal(size=(30, 3))
    q = np.array([0.0, 0.6, -0.8, 0])  # half a turn: units say it exactly
    positions = rest @ matrix_of(q).T + [1, 2, 3]
    quaternions = np.where(RNG.random((30, 1)) < 0.5, q, -q)  # both are the same rotation
    numbers = motions.measure(order, parent, rest, 1e-3, 0.2, positions, quaternions)
    moved, roots = np.flatnonzero(numbers.any(axis=1)), np.flatnonzero(parent < 0)
    assert moved.tolist() == roots.tolist()


def test_rotations_add_up_beyond_half_a_turn() -> None:
    n = 9
    order, parent = np.arange(n), np.arange(n) - 1
    numbers = np.zeros((n, 6), dtype=np.int64)
    numbers[:, 5] = 256  # a quarter of the angle has the tangent 1/4: 56 degrees each
    _, quaternions = motions.carry(order, parent, np.zeros((n, 3)), 1.0, 2.0**-10, numbers)
    angles = 2 * np.arctan2(quaternions[:, 3], quaternions[:, 0])
    np.testing.assert_allclose(np.unwrap(angles)[-1], 9 * 4 * np.arctan(0.25), atol=1e-12)


@pytest.mark.parametrize("bad", [-2, 5, 1 << 62])
def test_nodes_that_there_are_not_are_refused(bad: int) -> None:
    nodes, wrong = np.arange(5), np.array([0, 1, bad, 3, 4])
    rest, numbers = np.zeros((5, 3)), np.zeros((5, 6), dtype=np.int64)
    for order, parent in ((wrong, nodes - 1), (nodes, wrong)):
        with pytest.raises(ValueError, match="contradict"):
            motions.carry(order, parent, rest, 1.0, 1.0, numbers)
    with pytest.raises(ValueError, match="contradict"):
        motions.span(wrong, nodes, 5)
    with pytest.raises(ValueError, match="contradict"):
        motions.span(nodes, wrong, 5)
    indptr = np.array([0, 1, 1, 1, 1, 1], dtype=np.int32)
    with pytest.raises(ValueError, match="contradict"):
        motions.walk(indptr, np.array([min(bad, 1 << 30)], dtype=np.int32))
