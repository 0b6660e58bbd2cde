"""Shared parts of the conversions to and from other libraries."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from deltamesh.plugins._fields import (
    KINDS,
    attributes_of,
    by_name,
    dense_arrays,
    gaps_in_colours,
    keeping_order,
    names_key,
    parts_of,
    point_arrays,
    warn_of_losses,
)
from deltamesh_formats.polymesh.mesh import Attribute, from_triangles

HEAT = Attribute("heat", "vertex", np.array([[1.0], [2.0]]), index=np.array([1, 0, 1]))
MESH = replace(from_triangles(np.eye(3), np.array([[0, 1, 2]])), attributes=(HEAT,))


def test_arrays_by_name_are_flat_and_have_names_of_their_own() -> None:
    found = by_name([("a", np.ones((2, 1))), ("a", np.ones((2, 3))), ("b", np.ones(2))])
    assert {name: array.shape for name, array in found.items()} == {
        "a": (2,),
        "a_2": (2, 3),
        "b": (2,),
    }


def test_dense_arrays_have_a_row_for_each_element() -> None:
    ((name, rows),) = dense_arrays(MESH, "vertex")
    assert name == "heat"
    assert rows.ravel().tolist() == [2, 1, 2]
    assert dense_arrays(MESH, "vertex", [HEAT]) == dense_arrays(MESH, "face") == []


def test_arrays_that_do_not_fit_are_named() -> None:
    lost: list[str] = []
    arrays = {
        "good": np.zeros((3, 2)),
        "cube": np.zeros((3, 2, 2)),
        "short": np.zeros(2),
        "text": np.array(["a", "b", "c"]),
    }
    found = attributes_of("vertex", arrays, 3, lost)
    assert [(a.name, a.width) for a in found] == [("good", 2), ("cube", 4)]
    assert lost == [
        "the shape of the vertex array 'cube'",
        "the vertex array 'short'",
        "the vertex array 'text'",
    ]


def test_labels_and_names_are_parts_if_they_fit() -> None:
    found = parts_of("material", np.array([1, -1], np.int32), ["a", "b"], 2)
    assert found is not None
    assert (found.kind, found.names) == ("material", ("a", "b"))
    assert found.of_face.dtype == np.int64
    for labels in ([0], [0, 2], [0, -2], [0.0, 1.0], [[0, 1]]):
        assert parts_of("material", np.array(labels), ["a", "b"], 2) is None


def test_names_of_parts_have_a_key_for_each_kind() -> None:
    assert len({names_key(kind) for kind in KINDS}) == len(KINDS) == 5


def test_the_order_is_kept_unless_it_is_said_otherwise() -> None:
    assert keeping_order({"bits": 8}) == {"keep_order": True, "bits": 8}
    assert keeping_order({"keep_order": False}) == {"keep_order": False}


def test_losses_are_warned_of_once() -> None:
    warn_of_losses([], "a mesh")  # a warning would be an error here
    with pytest.warns(UserWarning, match=r"^not kept in a mesh: curves, lines$"):
        warn_of_losses(["curves", "lines", "curves"], "a mesh")


def test_gaps_in_colours_are_white_and_said() -> None:
    index = np.array([0, -1, 0])
    colour = Attribute("colour", "vertex", np.array([[7, 8, 9]], dtype="u1"), "colour", index, True)
    mesh = replace(MESH, attributes=(replace(HEAT, index=index), colour))
    said = ["gaps in colours (filled with white)"]
    assert gaps_in_colours(mesh) == said
    arrays, lost = point_arrays(mesh)
    assert lost == said
    assert dict(arrays)["colour"].tolist() == [[7, 8, 9], [255, 255, 255], [7, 8, 9]]
    assert gaps_in_colours(MESH) == []
