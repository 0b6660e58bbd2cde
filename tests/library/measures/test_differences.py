"""Differences by vertex, face and edge, by hand."""

from __future__ import annotations

import meshes
import numpy as np
import pytest

from deltamesh._measures.differences import Reference

# Two triangles that share the edge 0-1, and one without an area.
V = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [5, 5, 5], [6, 6, 6]])
F = np.array([[0, 1, 2], [1, 0, 3], [0, 4, 5]])


def test_distances_are_in_the_unit_and_angles_in_degrees() -> None:
    W = V.copy()
    W[3] = [0, 0, -1]  # the second face turns by 90 degrees
    d = Reference(V, F, 2.0).differences(W)
    assert d.distance == pytest.approx([0, 0, 0, np.sqrt(2) / 2, 0, 0])
    assert d.angle[:2] == pytest.approx([0, 90])
    assert d.change == pytest.approx([90])


def test_areas_are_those_of_the_reference() -> None:
    assert Reference(V, F, 2.0).areas == pytest.approx([1 / 4, 1 / 4, 0])


@pytest.mark.parametrize(("left", "lost"), [(1e-2, False), (2e-3, False), (5e-4, True), (0, True)])
def test_a_face_is_lost_where_less_than_a_thousandth_of_its_area_is_left(left, lost) -> None:
    W = V.copy()
    W[2] = [0, left, 0]
    d = Reference(V, F, 1.0).differences(W)
    assert d.lost.tolist() == [lost, False, False]
    assert not d.turned.any()


def test_a_face_that_turns_over_is_told_from_one_that_bends() -> None:
    W = V.copy()
    W[2], W[3] = [0, -1, 0.1], [0, -0.1, -1]
    assert Reference(V, F, 1.0).differences(W).turned.tolist() == [True, False, False]


def test_a_face_without_an_area_can_lose_none() -> None:
    W = V.copy()
    W[4] = [5, 5, 9]
    d = Reference(V, F, 1.0).differences(W)
    assert not (d.lost | d.turned).any()


def test_as_many_vertices_are_needed() -> None:
    with pytest.raises(ValueError, match="6 and 5 vertices"):
        Reference(V, F, 1.0).differences(V[:5])


def test_equal_positions_have_no_differences() -> None:
    V, F = meshes.torus(8, 6)
    d = Reference(V, F, 1.0).differences(V.copy())
    assert not d.distance.any()
    assert not d.angle.any()
    assert not d.change.any()
    assert not (d.lost | d.turned).any()
