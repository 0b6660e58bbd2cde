"""Poses of a surface: trees of anchors, what a motion makes of it, and streams of motions."""

from __future__ import annotations

import bars
import meshes
import numpy as np
import pytest
import spec_poses
from coders import neighbours_of
from rotations_oracle import matrix_of

from deltamesh._geometry import poses
from deltamesh._geometry.anchors import farthest
from deltamesh._geometry.cells import Cells
from deltamesh._geometry.editing import deformed
from deltamesh._geometry.poses import Pose, Tree
from deltamesh._geometry.rotations import to_quaternions
from deltamesh._geometry.solve import LeastSquares
from deltamesh._graph.adjacency import adjacency, components
from deltamesh._measures.metrics import diagonal
from deltamesh_formats.container.pose_table import PoseEntry
from deltamesh_formats.errors import FormatError, MeshError

MESHES = {name: meshes.every()[name] for name in ("torus", "grid", "two_components", "icosphere")}
STILL = np.array([1.0, 0, 0, 0])


def surface(name: str, count: int = 9) -> tuple[np.ndarray, tuple, np.ndarray, Tree]:
    V, F = MESHES[name]
    graph = adjacency(F, len(V))
    labels = components(*graph)
    anchors = farthest(*graph, labels, count)
    return V, graph, anchors, poses.tree_of(Cells(graph, labels, anchors))


def posed(name: str, pose: Pose, count: int = 9) -> tuple[np.ndarray, np.ndarray]:
    V, graph, anchors, tree = surface(name, count)
    system = LeastSquares(graph, anchors, weights=poses.WEIGHT)
    return poses.posed(graph, V, system, anchors, tree, pose)


def moved_as_one(name: str, q: np.ndarray, shift: np.ndarray, count: int = 9) -> Pose:
    V, _, anchors, tree = surface(name, count)
    rest = V[anchors]
    positions = rest @ matrix_of(q).T + shift
    return poses.measured("one", 1e-6, 20, tree, rest, positions, np.tile(q, (len(anchors), 1)))


@pytest.mark.parametrize("count", [1, 2, 9, 40])
@pytest.mark.parametrize("name", MESHES)
def test_trees_are_those_of_the_specification(name: str, count: int) -> None:
    V, _, anchors, tree = surface(name, count)
    near = neighbours_of(MESHES[name][1], len(V))
    borders = spec_poses.neighbours_of_cells(near, anchors.tolist())
    order, parents = spec_poses.tree(borders, len(anchors))
    assert tree.order.tolist() == order
    assert tree.parent.tolist() == [
        -1 if parents[a] is None else parents[a] for a in range(len(order))
    ]
    indptr, indices = tree.graph
    rows = [indices[indptr[i] : indptr[i + 1]].tolist() for i in range(len(indptr) - 1)]
    assert rows == spec_poses.graph_of_motions(order, borders)


@pytest.mark.parametrize("name", MESHES)
def test_without_motions_a_surface_is_at_rest(name: str) -> None:
    V, _, anchors, _ = surface(name)
    still = Pose("still", 1.0, 10, np.zeros((len(anchors), 6), dtype=np.int64))
    W, turns = posed(name, still)
    np.testing.assert_allclose(W, V, atol=1e-12)
    np.testing.assert_allclose(turns, np.broadcast_to(np.eye(3), turns.shape), atol=1e-12)


@pytest.mark.parametrize("name", MESHES)
def test_anchors_that_move_as_one_take_the_surface_with_them(name: str) -> None:
    q, shift = np.array([0.1, 0.7, -0.5, 0.5]), np.array([3.0, -1, 2])
    q /= np.linalg.norm(q)
    W, turns = posed(name, moved_as_one(name, q, shift))
    V, R = MESHES[name][0], matrix_of(q)
    np.testing.assert_allclose(W, V @ R.T + shift, atol=2e-5)
    np.testing.assert_allclose(turns, np.broadcast_to(R, turns.shape), atol=1e-5)


@pytest.mark.parametrize("name", MESHES)
def test_positions_are_those_of_the_specification(name: str) -> None:
    V, _, anchors, _ = surface(name)
    numbers = np.random.default_rng(4).integers(-60, 61, size=(len(anchors), 6))
    pose = Pose("any", 1e-3, 9, numbers)
    near = neighbours_of(MESHES[name][1], len(V))
    triple = pose.step, pose.octaves, numbers.tolist()
    wanted, _ = spec_poses.posed(triple, V, near, anchors.tolist())
    W, _ = posed(name, pose)
    np.testing.assert_allclose(W, wanted, atol=1e-9)


def test_a_bent_bar_goes_through_its_anchors_within_a_step() -> None:
    V, F = bars.bar()
    graph = adjacency(F, len(V))
    labels = components(*graph)
    X, turns = deformed(graph, V, bars.held(V, "bend"))
    anchors = farthest(*graph, labels, 50)
    tree = poses.tree_of(Cells(graph, labels, anchors))
    step, quaternions = diagonal(V) / 4096, to_quaternions(turns[anchors])
    pose = poses.measured("bent", step, 11, tree, V[anchors], X[anchors], quaternions)
    system = LeastSquares(graph, anchors, weights=poses.WEIGHT)
    W, _ = poses.posed(graph, V, system, anchors, tree, pose)
    assert np.abs(W[anchors] - X[anchors]).max() < step
    assert np.abs(W - X).max() < 0.01 * diagonal(V)


def test_neighbouring_decoders_agree() -> None:
    """Positions at rest that differ by noise make poses that differ by as much, nearly."""
    V, graph, anchors, tree = surface("torus", 20)
    numbers = np.random.default_rng(6).integers(-200, 201, size=(len(anchors), 6))
    system = LeastSquares(graph, anchors, weights=poses.WEIGHT)
    pose = Pose("any", 1e-3, 9, numbers)
    W, _ = poses.posed(graph, V, system, anchors, tree, pose)
    noise = 1e-9 * np.random.default_rng(7).uniform(-1, 1, V.shape)
    X, _ = poses.posed(graph, V + noise, system, anchors, tree, pose)
    assert np.abs(W - X).max() < 1e-7


@pytest.mark.parametrize("name", MESHES)
def test_streams_have_all_numbers(name: str) -> None:
    _, _, anchors, tree = surface(name)
    for spread in (0, 1, 1000):
        numbers = np.random.default_rng(8).integers(-spread, spread + 1, (len(anchors), 6))
        pose = Pose("é", 0.1, 10, numbers)
        found = poses.decode_pose(poses.encode_pose(pose, tree), tree)
        np.testing.assert_array_equal(found.numbers, numbers)
        assert (found.name, found.step, found.octaves) == ("é", 0.1, 10)


def test_what_does_not_move_takes_few_bytes() -> None:
    _, _, anchors, tree = surface("torus", 40)
    numbers = np.zeros((len(anchors), 6), dtype=np.int64)
    assert len(poses.encode_pose(Pose("still", 0.1, 10, numbers), tree).stream) < 8


def test_a_stream_that_goes_on_is_refused() -> None:
    _, _, anchors, tree = surface("torus")
    entry = poses.encode_pose(Pose("a", 0.1, 10, np.ones((len(anchors), 6), dtype=np.int64)), tree)
    longer = PoseEntry("a", 0.1, 10, bytes(entry.stream) + b"\1", 7)
    with pytest.raises(FormatError, match="should") as caught:
        poses.decode_pose(longer, tree)
    assert caught.value.offset is not None
    assert 7 < caught.value.offset <= 7 + len(longer.stream)


def test_motions_of_too_many_steps_are_refused() -> None:
    V, _, anchors, tree = surface("torus")
    far = V[anchors] + 1e6
    with pytest.raises(MeshError, match="too many steps"):
        poses.measured("far", 1e-4, 10, tree, V[anchors], far, np.tile(STILL, (len(far), 1)))


def test_the_digest_covers_all_of_a_pose() -> None:
    numbers = np.arange(12, dtype=np.int64).reshape(2, 6)
    name, fields, found = Pose("aé", 0.5, 3, numbers).arrays()
    assert name.tolist() == [0x61, 0xC3, 0xA9]
    assert fields.tolist() == [0x3FE0000000000000, 3]
    np.testing.assert_array_equal(found, numbers)
