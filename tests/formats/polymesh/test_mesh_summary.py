"""Summary of a mesh, in a line and for a notebook."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh, from_triangles
from deltamesh_formats.polymesh.summary import mesh_html, mesh_text

ONE = from_triangles(np.eye(3), np.array([[0, 1, 2]]))


def polygons(*sizes: int) -> PolyMesh:
    offsets = np.cumsum([0, *sizes])
    return PolyMesh(np.eye(3), np.zeros(offsets[-1], dtype=np.int64), offsets)


def test_polygons_are_named_by_their_corners() -> None:
    assert mesh_text(ONE) == "<PolyMesh: 3 vertices, 1 triangles>"
    assert "2 quads" in mesh_text(polygons(4, 4))
    assert "2 faces of 5 corners" in mesh_text(polygons(5, 5))
    assert "3 faces of 3 to 6 corners" in mesh_text(polygons(6, 3, 4))
    assert "0 triangles" in mesh_text(polygons())


def test_everything_that_a_mesh_holds_is_named() -> None:
    mesh = replace(
        ONE,
        attributes=(
            Attribute("heat", "vertex", np.zeros((3, 1))),
            Attribute("uv", "corner", np.zeros((3, 2), np.float32), "uv"),
        ),
        parts=(Parts("material", ("a", "b"), np.zeros(1, np.int64)),),
        metadata={"comments": ("x",)},
        lost=("curves",),
    )
    facts = (
        "vertex data: heat (float64); corner data: uv (float32 x 2); "
        "material: 2 parts; metadata: comments; lost: curves"
    )
    assert facts in mesh_text(mesh)
    html = mesh_html(mesh)
    for word in ("heat (float64)", "uv (float32 x 2)", "2 parts", "comments", "curves"):
        assert f"<td>{word}</td>" in html


def test_names_are_escaped() -> None:
    mesh = replace(ONE, lost=("<b>\x1b[2J",))
    assert r"\x1b[2J" in mesh_text(mesh)
    assert "\x1b" not in mesh_html(mesh)
    assert "&lt;b&gt;" in mesh_html(mesh)
