"""Hausdorff distance, by hand and by brute force."""

from __future__ import annotations

import meshes
import numpy as np
import oracle
import pytest

from deltamesh._measures import metrics
from deltamesh._measures.hausdorff import _surface_samples
from deltamesh._mesh import TriangleMesh

MESHES = meshes.every()
TRIANGLE = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize("name", MESHES)
def test_hausdorff_of_vertices_equals_brute_force(name: str, monkeypatch) -> None:
    monkeypatch.setattr(
        "deltamesh._measures.hausdorff._surface_samples", lambda t: (np.arange(0), t[:0, 0])
    )
    V, F = MESHES[name]
    F = F[:25]
    rng = np.random.default_rng(12)
    W = V + 0.2 * rng.normal(size=V.shape)
    for other in (F, F[:-1]):  # with corresponding faces, and without
        both = [(V[F].reshape(-1, 3), W[other]), (W[other].reshape(-1, 3), V[F])]
        expected = max(oracle.largest_squared_distance(p, t) for p, t in both) ** 0.5
        assert metrics.hausdorff(TriangleMesh(V, F), TriangleMesh(W, other)) == pytest.approx(
            expected, rel=1e-9
        )


def test_hausdorff_by_hand() -> None:
    V, F = meshes.grid(6, 6)
    V[:, 2] = 0
    spike = V.copy()
    spike[14, 2] = 0.7
    assert metrics.hausdorff(TriangleMesh(V, F), TriangleMesh(spike, F)) == pytest.approx(0.7)
    # A triangle that covers half of a square: the other corner is sqrt(1/2) from it.
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    square = TriangleMesh(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    half = TriangleMesh(square.vertices, square.faces[:1])
    assert metrics.hausdorff(square, half) == pytest.approx(0.5**0.5)
    assert metrics.hausdorff(half, square) == pytest.approx(0.5**0.5)


def test_hausdorff_sees_between_the_vertices() -> None:
    # The faces of a regular tetrahedron of height 2 / sqrt(3), two and two: the middle of the edge
    # between two of them is half a height from the others.
    V = np.array([[0.0, 0, 0], [1, 0, 1], [1, 1, 0], [0, 1, 1]])
    one = TriangleMesh(V, np.array([[0, 1, 2], [0, 2, 3]]))
    other = TriangleMesh(V, np.array([[0, 1, 3], [1, 2, 3]]))
    assert metrics.hausdorff(one, other) == pytest.approx(3**-0.5, rel=0.02)


def test_surface_samples_follow_the_area() -> None:
    triangles = np.stack((TRIANGLE, 2 * TRIANGLE, 0 * TRIANGLE, 3 * TRIANGLE))
    face, barycentric = _surface_samples(triangles)
    share = np.bincount(face, minlength=4) / len(face)
    np.testing.assert_allclose(share, np.array([1, 4, 0, 9]) / 14, atol=1e-3)
    assert (barycentric >= 0).all()
    np.testing.assert_allclose(barycentric.sum(axis=1), 1)
    np.testing.assert_allclose(barycentric.mean(axis=0), 1 / 3, atol=1e-2)
