"""Distances and angles between two meshes, by hand and by brute force."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest

from deltamesh._graph.adjacency import edges
from deltamesh._measures import metrics
from deltamesh._mesh import TriangleMesh

MESHES = meshes.every()

# Two triangles that share the edge 0-1; the second one is folded up or down about it.
HINGE = np.array([[0, 1, 2], [1, 0, 3]])


def hinge(degrees):
    """Vertices of a hinge, flat at 0 and convex above."""
    angle = np.radians(degrees)
    return np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -np.cos(angle), -np.sin(angle)]])


@pytest.mark.parametrize("name", MESHES)
def test_equal_meshes_have_no_error(name: str) -> None:
    V, F = MESHES[name]
    errors = metrics.compare(TriangleMesh(V, F), TriangleMesh(V.copy(), F))
    for field in ("rms", "max", "normal_deviation", "dihedral", "hausdorff", "visual"):
        assert getattr(errors, field) == 0, field
    assert errors.diagonal == pytest.approx(np.linalg.norm(V.max(axis=0) - V.min(axis=0)))


def test_vertex_distances_by_hand() -> None:
    V = np.zeros((4, 3))
    V[3] = [2, 0, 0]
    W = V + np.array([[0.0, 0, 0], [0, 3, 0], [0, 0, 4], [0, 0, 0]])
    errors = metrics.vertex_errors(V, W, np.array([[0, 1, 2]]))
    assert errors.rms == pytest.approx(2.5)  # sqrt((9 + 16) / 4)
    assert errors.max == pytest.approx(4)


def test_normal_deviation_is_weighted_by_area() -> None:
    # Triangles of area 2 and 1/2; the larger is turned by 90 degrees about its side on the x axis.
    V = np.array([[0.0, 0, 0], [2, 0, 0], [0, 2, 0], [5, 0, 0], [6, 0, 0], [5, 1, 0]])
    W = V.copy()
    W[2] = [0, 0, 2]
    F = np.arange(6).reshape(2, 3)
    assert metrics.vertex_errors(V, W, F).normal_deviation == pytest.approx(90 * 4 / 5)


def dihedral(V: np.ndarray, W: np.ndarray, F: np.ndarray) -> float:
    return metrics.vertex_errors(V, W, F).dihedral


@pytest.mark.parametrize(
    ("before", "after", "change"), [(0, 30, 30), (20, -20, 40), (170, -170, 20), (90, 90, 0)]
)
def test_dihedral_change_by_hand(before: float, after: float, change: float) -> None:
    assert dihedral(hinge(before), hinge(after), HINGE) == pytest.approx(change, abs=1e-12)
    # The same two triangles, one of them turned over.
    turned = np.array([[0, 1, 2], [0, 1, 3]])
    assert dihedral(hinge(before), hinge(after), turned) == pytest.approx(change, abs=1e-12)


def test_tiny_angles_are_not_lost() -> None:
    assert dihedral(hinge(0), hinge(1e-9), HINGE) == pytest.approx(1e-9, rel=1e-5)


@pytest.mark.parametrize("name", ["icosphere", "double_torus", "grid", "two_components"])
def test_dihedral_equals_its_oracle(name: str) -> None:
    V, F = MESHES[name]
    W = V + 0.05 * np.random.default_rng(71).normal(size=V.shape)
    before, after = oracle.dihedral_angles(V, F), oracle.dihedral_angles(W, F)
    change = [abs(before[edge] - after[edge]) for edge in before]
    expected = np.mean([min(c, 360 - c) for c in change])
    assert dihedral(V, W, F) == pytest.approx(expected, rel=1e-6)


def test_edges_of_three_faces_are_no_dihedral() -> None:
    V, F = meshes.three_pages()
    assert dihedral(V, V[:, ::-1].copy(), F) == 0


def test_geometric_laplacian_by_hand() -> None:
    # Vertex 0 has neighbours at distances 1 and 2: weights 1 and 1/2, mean (2/3, 2/3, 0).
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0], [7, 7, 7]])
    laplacian = metrics.geometric_laplacian(V, edges(np.array([[0, 1, 2]]), 4))
    np.testing.assert_allclose(laplacian[0], [-2 / 3, -2 / 3, 0])
    np.testing.assert_array_equal(laplacian[3], 0)


def test_visual_error_weighs_distance_and_laplacian() -> None:
    V, F = meshes.icosphere(1)
    moved = V + np.array([0.5, 0, 0])  # the Laplacians stay
    assert metrics.visual_error(V, moved, F) == pytest.approx(0.15 * 0.5)
    scaled = metrics.geometric_laplacian(V, edges(F, len(V)))
    sq = np.sqrt((scaled**2).sum(axis=1).mean())
    assert metrics.visual_error(V, 2 * V, F) == pytest.approx(0.15 + 0.85 * sq)


@pytest.mark.parametrize("unit", [1e-200, 1.0, 1e150])
def test_errors_scale_with_the_unit_and_ignore_the_origin(unit: float) -> None:
    V, F = meshes.torus(9, 7)
    W = V + 0.01 * np.random.default_rng(8).normal(size=V.shape)
    one = vars(metrics.compare(TriangleMesh(V, F), TriangleMesh(W, F)))
    other = vars(metrics.compare(TriangleMesh(unit * (V + 7), F), TriangleMesh(unit * (W + 7), F)))
    for name, value in one.items():
        angle = name in ("normal_deviation", "dihedral")
        assert other[name] == pytest.approx(value if angle else unit * value, rel=1e-6, abs=0), name


def test_faces_without_area() -> None:
    # A sliver of no area, a face that repeats a vertex, and one that loses its area.
    V = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0]])
    F = np.array([[0, 1, 2], [3, 3, 4], [0, 1, 3], [1, 4, 3]])
    W = V.copy()
    W[4] = V[3]
    errors = metrics.compare(TriangleMesh(V, F), TriangleMesh(W, F))
    assert errors.normal_deviation == pytest.approx(45)  # half of the area counts 90 degrees
    assert np.isfinite(list(vars(errors).values())).all()


def test_a_mesh_without_area_faces_or_vertices() -> None:
    point = TriangleMesh(np.ones((3, 3)), np.array([[0, 1, 2]]))
    assert set(vars(metrics.compare(point, point)).values()) == {0.0}
    nothing = TriangleMesh(np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))
    assert set(vars(metrics.compare(nothing, nothing)).values()) == {0.0}


def test_meshes_that_do_not_correspond_are_refused() -> None:
    V, F = meshes.icosphere(1)
    with pytest.raises(ValueError, match="same faces"):
        metrics.compare(TriangleMesh(V, F), TriangleMesh(V, F[::-1]))
    with pytest.raises(ValueError, match="one by one"):
        metrics.compare(TriangleMesh(V, F), TriangleMesh(V[:-1], F))
    with pytest.raises(ValueError, match="without faces"):
        metrics.hausdorff(TriangleMesh(V, F), TriangleMesh(V, F[:0]))
