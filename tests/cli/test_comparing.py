"""Comparison of two meshes, as an object and as text."""

from __future__ import annotations

from dataclasses import replace

import meshes
import numpy as np
import pytest

from deltamesh_cli.comparing import compare_meshes, comparison_object, comparison_text
from deltamesh_cli.meshes import LoadedMesh
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles

V, F = meshes.icosphere(1)
HEAT = Attribute("heat", "vertex", np.arange(len(V)) / 1.0)
HEAT = replace(HEAT, values=HEAT.values[:, None])
A = replace(
    from_triangles(V, F),
    attributes=(HEAT,),
    parts=(Parts("group", ("all",), np.zeros(len(F), np.int64)),),
)


def silent(stage: str) -> None:
    """Tell nobody."""


def compared(a: PolyMesh, b: PolyMesh):
    return compare_meshes(LoadedMesh(a, 100, None), LoadedMesh(b, 50, None), silent)


def test_a_mesh_is_like_itself() -> None:
    found = comparison_object("a", "b", compared(A, A))
    errors = dict(found["errors"])
    assert errors.pop("diagonal") > 0
    assert (errors.pop("parts"), errors.pop("worst_part")) == (1, None)
    assert set(errors.values()) == {0.0}
    assert [one["largest_difference"] for one in found["attributes"]] == [0.0]
    assert found["parts"] == [{"kind": "group", "a": 1, "b": 1, "alike": True}]
    text = comparison_text("a", "b", compared(A, A))
    assert "a: 100 bytes, 42 vertices, 80 faces" in text
    assert "alike" in text
    assert "not alike" not in text


def test_differences_are_measured() -> None:
    hotter = replace(HEAT, values=HEAT.values + 0.5)
    b = replace(A, vertices=V + np.array([0.25, 0, 0]), attributes=(hotter,), parts=())
    found = comparison_object("a", "b", compared(A, b))
    errors = found["errors"]
    assert errors["rms"] == pytest.approx(0.25)
    assert errors["max_relative"] == pytest.approx(0.25 / errors["diagonal"])
    assert [one["largest_difference"] for one in found["attributes"]] == [0.5]
    assert found["parts"] == [{"kind": "group", "a": 1, "b": 0, "alike": False}]
    assert "not alike" in comparison_text("a", "b", compared(A, b))


def test_surfaces_are_measured_where_vertices_do_not_correspond() -> None:
    other = from_triangles(*meshes.icosphere(2))
    found = comparison_object("a", "b", compared(A, other))
    assert found["errors"]["rms"] is None
    assert found["errors"]["hausdorff"] > 0
    assert found["attributes"] is None is found["parts"]
    assert " -" in comparison_text("a", "b", compared(A, other))
