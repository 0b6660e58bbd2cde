"""Formats of mesh files: what they do not hold of a mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from deltamesh_formats.meshfiles.file_format import FileFormat, Written
from deltamesh_formats.polymesh.mesh import Attribute, Parts, PolyMesh


def nothing(_: object) -> PolyMesh:
    raise NotImplementedError


PLAIN = FileFormat(
    name="plain",
    title="Plain",
    extensions=("plain",),
    bytes_per_vertex=12,
    read=nothing,
    write=lambda mesh: Written(b"", ()),
)
HEAT = Attribute("heat", "vertex", np.zeros((4, 1)))
MESH = PolyMesh(
    np.eye(4, 3),
    np.arange(4),
    np.array([0, 4]),
    (HEAT, Attribute("normal", "vertex", np.zeros((4, 3)), "normal")),
    (Parts("object", ("a",), np.zeros(1, np.int64), 2 * np.eye(4)[None]),),
    {"mtllib": ("x.mtl",), "comments": ("hello",)},
    lost=("curves",),
)


def test_a_plain_format_loses_all_but_triangles() -> None:
    assert PLAIN.losses(MESH, ()) == (
        "curves",
        "polygons of more than three corners",
        "heat of vertices",
        "normals",
        "objects",
        "transforms",
        "material libraries",
    )


def test_a_format_loses_what_it_does_not_name() -> None:
    able = replace(
        PLAIN, polygons=True, transforms=True, parts=("object",), metadata=("mtllib", "comments")
    )
    assert able.losses(MESH, MESH.attributes) == ("curves",)
    assert able.losses(MESH, (HEAT,)) == ("curves", "normals")
    assert replace(able, transforms=False).losses(MESH, MESH.attributes) == ("curves", "transforms")
