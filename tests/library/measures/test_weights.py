"""Weights of errors: what is important counts in full, the rest by its importance."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest

from deltamesh._measures.measure import Measure, errors_by_importance
from deltamesh._measures.metrics import reference_of, vertex_errors
from deltamesh._measures.parts import parts_of
from deltamesh._measures.weights import mean_errors, weighted_errors, weights_of

V, F = meshes.torus(24, 16)
RNG = np.random.default_rng(7)
NOISE = 0.01 * RNG.normal(size=V.shape)
LEFT = V[:, 0] < 0
W = np.where(LEFT, 0.25, 1.0)
NAMES = ("rms", "max", "normal_deviation", "dihedral")


def errors(found: object) -> list[float]:
    return [getattr(found, name) for name in NAMES]


def test_weights_of_faces_and_edges_are_the_least_of_their_corners() -> None:
    reference = reference_of(V, F)
    weights = weights_of(reference, W)
    np.testing.assert_array_equal(weights.vertices, W)
    np.testing.assert_array_equal(weights.faces, [min(W[list(face)]) for face in F])
    left, right = reference.edges.T // 3
    for edge, a, b in zip(weights.edges, left, right, strict=True):
        assert edge == min(W[[*F[a], *F[b]]])


def test_importance_of_1_changes_nothing() -> None:
    reference = reference_of(V, F)
    d = reference.differences(V + NOISE)
    weights = weights_of(reference, np.ones(len(V)))
    expected = errors(vertex_errors(V, V + NOISE, F))
    np.testing.assert_allclose(errors(weighted_errors(reference, d, weights)), expected, rtol=1e-12)


def test_errors_that_are_divided_by_the_importance_keep_a_bound() -> None:
    """Distances exactly: B / w everywhere weighs as B does."""
    moved = V + 0.01 * np.array([0, 0, 1]) / W[:, None]
    reference = reference_of(V, F)
    found = weighted_errors(reference, reference.differences(moved), weights_of(reference, W))
    assert found.rms == pytest.approx(0.01)
    assert found.max == pytest.approx(0.01)


@pytest.mark.parametrize("outside", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("scale", [0.1, 1.0, 30.0])
def test_what_is_bounded_is_never_below_the_errors_at_importance_1(
    outside: float, scale: float
) -> None:
    """Whatever the others do: they cannot make up for them."""
    importance = np.where(LEFT, outside, 1.0)
    moved = V + NOISE * np.where(LEFT, scale, 1.0)[:, None]
    reference = reference_of(V, F)
    weights = weights_of(reference, importance)
    d = reference.differences(moved)
    bounded = errors(weighted_errors(reference, d, weights))
    full, reduced = errors_by_importance(V, F, moved, importance)
    assert (np.array(bounded) >= np.array(errors(full)) * (1 - 1e-6)).all()
    # The region by itself, by definition.
    inside = ~LEFT[F].any(axis=1)
    angle, areas = d.angle[inside], reference.areas[inside]
    assert full.normal_deviation == pytest.approx((angle * areas).sum() / areas.sum(), rel=1e-6)
    distance = np.linalg.norm(moved - V, axis=1)
    assert full.rms == pytest.approx(np.sqrt((distance[~LEFT] ** 2).mean()))
    assert full.max == pytest.approx(distance[~LEFT].max())
    assert reduced.rms == pytest.approx(np.sqrt((distance[LEFT] ** 2).mean()))


def test_no_importance_has_no_error() -> None:
    moved = V + 9 * NOISE * LEFT[:, None]
    reference = reference_of(V, F)
    weights = weights_of(reference, np.where(LEFT, 0.0, 1.0))
    d = reference.differences(moved)
    # Faces at the border have a corner of no importance.
    assert errors(weighted_errors(reference, d, weights)) == [0, 0, 0, 0]
    nothing = weights_of(reference, np.zeros(len(V)))
    assert errors(mean_errors(reference, d, nothing)) == [0, 0, 0, 0]


def test_parts_are_weighted_too() -> None:
    """Each as if it were alone: the means of parts are over their own elements."""
    far = V + np.array([9, 0, 0])
    both, faces = np.concatenate([V, far]), np.concatenate([F, F + len(V)])
    component = np.repeat([0, 1], len(V))
    parts = parts_of(faces, component)
    importance = np.concatenate([W, np.zeros(len(V))])
    moved = both + np.concatenate([NOISE, 3 * NOISE])
    found = Measure(both, faces, parts, importance)(moved).parts
    assert found is not None
    reference = reference_of(V, F)
    weights = weights_of(reference, W)
    alone = mean_errors(reference, weights.of(reference.differences(V + NOISE)), weights)
    for name in NAMES:
        first, second = getattr(found, name)
        assert first == pytest.approx(getattr(alone, name), rel=1e-6)
        assert second == 0
    plain = Measure(both, faces, parts)(moved).parts
    ones = Measure(both, faces, parts, np.ones(len(both)))(moved).parts
    for name in (*NAMES, "diagonal"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(ones, name))


def test_weights_scale_differences() -> None:
    reference = reference_of(V, F)
    weights = weights_of(reference, W)
    d = reference.differences(V + NOISE)
    scaled = weights.of(d)
    np.testing.assert_array_equal(scaled.distance, W * d.distance)
    np.testing.assert_array_equal(scaled.lost, d.lost)
    assert replace(weights).full.vertices.sum() == (W == 1).sum()
    assert weights.reduced.vertices.sum() == (W < 1).sum()
