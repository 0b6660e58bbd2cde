"""Meshes that are made by hand: whatever a field has that it cannot have is named."""

from __future__ import annotations

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles.files import write_mesh
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh
from deltamesh_formats.polymesh.validation import checked

HEAT = Attribute("heat", "vertex", np.arange(4.0)[:, None])
LEFT = Parts("group", ("left",), np.zeros(2, dtype=np.int64))
MESH = PolyMesh(
    np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0.0]]),
    np.array([0, 1, 2, 1, 3, 2]),
    np.array([0, 3, 6]),
    attributes=(HEAT,),
    parts=(LEFT,),
    metadata={"comments": ("by hand",)},
)
# Of a wrong type, whatever the field is.
WRONG = (None, 3, 2.5, [1, 2], np.zeros(0), np.array("a"), object(), b"x", float("nan"))
FIELDS: dict[str, tuple[Any, ...]] = {
    "vertices": (*WRONG, "a", MESH.vertices[:, :2], MESH.corners),
    "corners": (*WRONG, "a", MESH.vertices, MESH.corners.astype(np.int32)),
    "offsets": (*WRONG, "a", np.array([0, 6, 3])),
    "attributes": (*WRONG, "a", (HEAT, LEFT)),
    "parts": (*WRONG, "a", (LEFT, HEAT)),
    "metadata": (*WRONG, "a", {3: ("a",)}, {"comments": "a"}, {"comments": (3,)}),
    "lost": (*WRONG, "a", ("a", 3)),
    "precision": (*WRONG, "float16"),
    "format": WRONG,
    "margin": (None, [1, 2], np.zeros(0), object(), b"x", float("nan"), "a", -1.0, True),
}
OF_ATTRIBUTES: dict[str, tuple[Any, ...]] = {
    "name": WRONG,
    "domain": (*WRONG, "edge"),
    "values": (*WRONG, "a", np.array([["a"]] * 4), np.zeros((3, 1))),
    "role": (*WRONG, "texture"),
    "index": (3, 2.5, "a", [1, 2], np.zeros(0), np.array([0, 0, 0, 9]), np.zeros(4)),
    "normalized": (*WRONG, "a"),
    "margin": FIELDS["margin"],
}
OF_PARTS: dict[str, tuple[Any, ...]] = {
    "kind": (*WRONG, "layer"),
    "names": (*WRONG, "a", (3,), ()),
    "of_face": (*WRONG, "a", np.array([0, 9]), np.zeros(3, dtype=np.int64)),
    "transforms": (3, 2.5, "a", [1, 2], np.zeros(0), np.eye(4)),
}
CASES = [
    *((name, name, {name: value}) for name, values in FIELDS.items() for value in values),
    *(
        (f"attribute {name}", "attribute", {"attributes": (replace(HEAT, **{name: value}),)})
        for name, values in OF_ATTRIBUTES.items()
        for value in values
    ),
    *(
        (f"parts {name}", "parts", {"parts": (replace(LEFT, **{name: value}),)})
        for name, values in OF_PARTS.items()
        for value in values
    ),
]


def test_a_mesh_that_is_whole_passes() -> None:
    assert checked(MESH).vertices is MESH.vertices
    write_mesh(io.BytesIO(), MESH, "ply")


@pytest.mark.parametrize(
    ("words", "fields"),
    [
        pytest.param(words, fields, id=f"{name} {i}")
        for i, (name, words, fields) in enumerate(CASES)
    ],
)
def test_what_no_field_can_have_is_named(words: str, fields: dict[str, Any]) -> None:
    wrong = replace(MESH, **fields)
    with pytest.raises(MeshError, match=words):
        checked(wrong)
    with pytest.raises(MeshError, match=words):
        write_mesh(io.BytesIO(), wrong, "ply")


def test_faces_without_their_vertices_are_not_written() -> None:
    wrong = replace(MESH, corners=MESH.corners + 1)
    with pytest.raises(MeshError, match=r"face 1 has vertex indices \[2, 4, 3\], outside 0\.\.3"):
        write_mesh(io.BytesIO(), wrong, "obj")
