"""Differences by vertex, face and edge, against one after the other."""

from __future__ import annotations

from dataclasses import astuple

import differences_oracle
import meshes
import numpy as np
import pytest

from deltamesh._kernels.mesh import differences
from deltamesh._measures.differences import LOST, TURNED, Reference

MESHES = meshes.every()
SCALES = [1e-310, 1e-290, 1e-150, 1.0, 1e140]


def noisy(V: np.ndarray, seed: int = 7) -> np.ndarray:
    return V + 0.3 * np.random.default_rng(seed).normal(size=V.shape) * np.ptp(V, axis=0).max()


def edges_of(V: np.ndarray, F: np.ndarray) -> tuple[np.ndarray, ...]:
    """The ends of the interior edges, the faces beside them, and whether both run the same way."""
    left, right = Reference(V, F, 1.0).edges.T
    start, end = F.ravel(), np.roll(F, -1, axis=1).ravel()
    ends = np.stack((start[left], end[left]), axis=1)
    return ends, left // 3, right // 3, start[left] == start[right]


def expected(V: np.ndarray, W: np.ndarray, F: np.ndarray, unit: float) -> tuple[np.ndarray, ...]:
    """The differences, one after the other."""
    before, after = ([differences_oracle.face_normal(X, f, unit) for f in F] for X in (V, W))
    changed = [
        differences_oracle.face_change(*pair, LOST, TURNED)
        for pair in zip(before, after, strict=True)
    ]
    change = []
    for pair, left, right, same in zip(*edges_of(V, F), strict=True):
        a, b = (
            differences_oracle.dihedral_angle(X, normals[left][0], normals[right][0], pair, same)
            for X, normals in ((V, before), (W, after))
        )
        change.append(min(abs(a - b), 360 - abs(a - b)))
    angle, lost, turned = np.array(changed).reshape(-1, 3).T
    distance = [differences_oracle.distance(v, w, unit) for v, w in zip(V, W, strict=True)]
    was, left = (sum(area for _, area in normals) for normals in (before, after))
    area = left / was if was else 1.0
    return np.array(distance), angle, np.array(change), lost == 1, turned == 1, np.float64(area)


def assert_as_expected(V: np.ndarray, W: np.ndarray, F: np.ndarray, unit: float) -> None:
    found = astuple(Reference(V, F, unit).differences(W))
    for one, other in zip(map(np.asarray, found), expected(V, W, F, unit), strict=True):
        assert one.dtype == other.dtype
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-11)


@pytest.mark.parametrize("name", MESHES)
def test_differences_equal_their_twins(name: str) -> None:
    V, F = MESHES[name]
    assert_as_expected(V, noisy(V), F, 0.7)
    assert_as_expected(noisy(V), V, F, 3.0)


@pytest.mark.parametrize("scale", SCALES)
def test_differences_at_any_scale(scale: float) -> None:
    V, F = meshes.torus(9, 7)
    V = np.round(V * 2**12) / 2**12
    assert_as_expected(V * scale, np.round(noisy(V) * 2**12) / 2**12 * scale, F, scale)


def test_areas_equal_their_twins() -> None:
    rng = np.random.default_rng(11)
    V = rng.normal(size=(900, 3)) * 10.0 ** rng.uniform(-120, 120, (900, 1))
    V[::3] = 0  # so that the two sides are of unlike lengths
    F = np.arange(900).reshape(-1, 3)
    normals, areas = differences.face_normals(V, F, 2.0)
    for normal, area, face in zip(normals, areas, F, strict=True):
        wanted, size = differences_oracle.face_normal(V, face, 2.0)
        np.testing.assert_allclose(area, size, rtol=1e-12)
        assert differences_oracle.angle(normal, wanted) < 1e-6


@pytest.mark.parametrize("exponents", [(-1074, 1000), (-1074, -40), (-990, -80), (500, 510)])
def test_areas_of_sides_at_the_ends_of_double_precision(exponents: tuple[int, int]) -> None:
    V = np.zeros((3, 3))
    V[1, 0], V[2, 1] = np.ldexp(1.0, exponents)
    normals, areas = differences.face_normals(V, np.array([[0, 1, 2]]), 1.0)
    assert areas.tolist() == [np.ldexp(1.0, sum(exponents))]
    assert normals[0, 2] > 0 == abs(normals[0, :2]).max()


def test_far_from_the_origin_nothing_is_lost() -> None:
    V, F = meshes.torus(8, 6)
    V = np.round(V * 2**20) / 2**20
    W = np.round(noisy(V) * 2**20) / 2**20
    near, far = (Reference(V + at, F, 1.0).differences(W + at) for at in (0.0, 2.0**30))
    for one, other in zip(astuple(near), astuple(far), strict=True):
        assert np.asarray(one).tobytes() == np.asarray(other).tobytes()


# A triangle, a line, a point, one with a corner that is no number, and one with an infinite one.
CORNERS = np.array(
    [
        [[0, 0, 0], [1, 0, 0], [0, 1, 0]],
        [[0, 0, 0], [1, 1, 1], [2, 2, 2]],
        [[3, 3, 3], [3, 3, 3], [3, 3, 3]],
        [[0, 0, 0], [1, np.nan, 0], [0, 1, 0]],
        [[0, 0, 0], [1, 0, 0], [np.inf, 1, 0]],
        [[0, 0, 0], [0, 1, 0], [1, 0, 0]],
        [[0, 0, 0], [1, 0, 0], [0, 1e-4, 0]],
    ],
    dtype=float,
)


def test_faces_without_an_area_or_a_number_are_classified_alike() -> None:
    count = len(CORNERS)
    V = np.repeat(CORNERS, count, axis=0).reshape(-1, 3)
    W = np.tile(CORNERS, (count, 1, 1)).reshape(-1, 3)
    F = np.arange(len(V)).reshape(-1, 3)
    before, after = (differences.face_normals(X, F, 1.0) for X in (V, W))
    found = np.array(differences.face_changes(before, after, LOST, TURNED)).T
    with np.errstate(invalid="ignore"):
        for face, row in zip(F, found, strict=True):
            pair = (differences_oracle.face_normal(X, face, 1.0) for X in (V, W))
            wanted = differences_oracle.face_change(*pair, LOST, TURNED)
            np.testing.assert_allclose(row, wanted, rtol=1e-12)


def test_dihedral_angles_beside_a_face_that_is_no_number() -> None:
    V, F = meshes.grid(4, 4)
    V[5, 1] = np.nan
    normals, areas = differences.face_normals(V, F, 1.0)
    angles = differences.dihedral_angles(V, normals, F, Reference(V, F, 1.0).edges)
    pairs, left, right, _ = edges_of(V, F)
    touched = np.isnan(areas)[left] | np.isnan(areas)[right]
    assert len(pairs) > touched.sum() > 0
    np.testing.assert_array_equal(np.isnan(angles), touched)


def test_an_edge_of_two_faces_that_run_the_same_way() -> None:
    V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    F = np.array([[0, 1, 2], [0, 1, 3]])
    assert edges_of(V, F)[3].tolist() == [True]
    normals, pairs = differences.face_normals(V, F, 1.0)[0], Reference(V, F, 1.0).edges
    (found,) = differences.dihedral_angles(V, normals, F, pairs)
    assert abs(found) == 90


@pytest.mark.parametrize("bad", [-1, 4, 1 << 62])
def test_indices_of_no_vertex_and_no_face_are_refused(bad: int) -> None:
    V, F = np.random.default_rng(5).normal(size=(4, 3)), np.array([[0, 1, 2], [2, 1, 3]])
    normals, _ = differences.face_normals(V, F, 1.0)
    pairs, wrong = Reference(V, F, 1.0).edges, np.where(F == 3, bad, F)
    with pytest.raises(ValueError, match="contradict"):
        differences.face_normals(V, wrong, 1.0)
    with pytest.raises(ValueError, match="contradict"):
        differences.dihedral_angles(V, normals, wrong, pairs)
    for h in (-1, 6, (1 << 31) - 1):
        with pytest.raises(ValueError, match="contradict"):
            differences.dihedral_angles(V, normals, F, np.array([[0, h]], dtype=np.int32))
