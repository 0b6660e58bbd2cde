"""Edits at full precision: handles land, bends and twists keep details, points are dragged."""

from __future__ import annotations

import bars
import numpy as np
import pytest
from rotations_oracle import matrix_of

from deltamesh._geometry.editing import Held, deformed
from deltamesh._graph.adjacency import adjacency
from deltamesh._measures.metrics import diagonal, vertex_errors

V, F = bars.bar()
GRAPH = adjacency(F, len(V))
STILL = np.array([1.0, 0, 0, 0])


@pytest.mark.parametrize(("name", "dihedral"), [("bend", 0.72), ("twist", 2.16)])
def test_details_turn_with_a_bar(name: str, dihedral: float) -> None:
    held = bars.held(V, name)
    W, turns = deformed(GRAPH, V, held)
    assert np.abs(W[held.vertices] - held.positions).max() < 1e-9 * diagonal(V)
    assert vertex_errors(V, W, F).dihedral <= dihedral
    np.testing.assert_allclose(turns @ turns.swapaxes(1, 2), [np.eye(3)] * len(V), atol=1e-9)


def test_what_is_moved_as_one_body_stays_one() -> None:
    q = np.array([0.4, 0.2, -0.8, 0.4]) / 1.0
    q /= np.linalg.norm(q)
    vertices = np.array([0, 40, 3000])
    positions = V[vertices] @ matrix_of(q).T + [1, 2, 3]
    known = np.ones(3, dtype=bool)
    W, _ = deformed(GRAPH, V, Held(vertices, positions, np.tile(q, (3, 1)), known))
    np.testing.assert_allclose(W, V @ matrix_of(q).T + [1, 2, 3], atol=1e-8)


def test_rotations_that_are_not_given_are_found() -> None:
    """A point is dragged: the surface around it turns, and bends less than if it did not."""
    fixed, tip = np.flatnonzero(V[:, 2] < 0.3), np.array([len(V) - 20])
    vertices = np.concatenate((fixed, tip))
    positions = V[vertices].copy()
    positions[-1] += [2.0, 0, -0.5]
    quaternions, known = np.tile(STILL, (len(vertices), 1)), vertices != tip
    free, turns = deformed(GRAPH, V, Held(vertices, positions, quaternions, known))
    stiff, _ = deformed(GRAPH, V, Held(vertices, positions, quaternions, known | True))
    for W in (free, stiff):
        assert np.abs(W[vertices] - positions).max() < 1e-8
    assert vertex_errors(V, free, F).dihedral < 0.8 * vertex_errors(V, stiff, F).dihedral
    angle = np.degrees(np.arccos((np.trace(turns[tip[0]]) - 1) / 2))
    assert 5 < angle < 60
    assert turns[tip[0]][0, 2] > 0  # about y, towards x


def test_inputs_stay() -> None:
    held = bars.held(V, "bend")
    kept = held.quaternions.copy(), held.positions.copy(), V.copy()
    deformed(GRAPH, V, held)
    for now, before in zip((held.quaternions, held.positions, V), kept, strict=True):
        np.testing.assert_array_equal(now, before)
