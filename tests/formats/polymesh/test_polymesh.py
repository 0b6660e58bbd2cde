"""The mesh of polygons: how it is cut into triangles, checked, and told in words."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import polymeshes
import pytest
from hypothesis import given
from hypothesis import strategies as st
from polymeshes import Kind

from deltamesh_formats.errors import MeshError
from deltamesh_formats.polymesh.descriptions import describe_attribute, losses_of
from deltamesh_formats.polymesh.mesh import (
    Attribute,
    Parts,
    PolyMesh,
    from_triangles,
    keep_faces,
)
from deltamesh_formats.polymesh.validation import checked

ANY = polymeshes.polymeshes(
    (
        Kind("vertex", ("f4", "u1"), (1, 3)),
        Kind("corner", ("f8", "i4"), (2,), partly=True),
        Kind("face", ("f8", "u2"), (1, 4), partly=True),
    ),
    largest=9,
    part_names={"object": polymeshes.names, "material": polymeshes.names},
)


def polygon(*points) -> PolyMesh:
    flat = np.array([[*p, 0.0][:3] for p in points], dtype=float)
    return PolyMesh(flat, np.arange(len(flat)), np.array([0, len(flat)]))


def test_a_mesh_without_faces_has_no_triangles():
    assert from_triangles(np.eye(3), np.empty((0, 3), dtype=int)).triangles.shape == (0, 3)


# What is kept and refused


@given(ANY, st.data())
def test_faces_that_are_kept_keep_what_they_have(mesh, data):
    keep = np.array([data.draw(st.booleans()) for _ in mesh.sizes])
    found = keep_faces(mesh, keep)
    polygons, left = (np.split(m.corners, m.offsets[1:-1]) for m in (mesh, found))
    if keep.any():
        assert [p.tolist() for p in left] == [
            p.tolist() for p, k in zip(polygons, keep, strict=True) if k
        ]
    masks = {"vertex": np.ones(len(mesh.vertices), bool), "face": keep}
    masks["corner"] = np.repeat(keep, mesh.sizes)
    for a, b in zip(mesh.attributes, found.attributes, strict=True):
        before, after = (polymeshes._rows(x) for x in (a, b))
        assert after == [r for r, k in zip(before, masks[a.domain], strict=True) if k]
    for a, b in zip(mesh.parts, found.parts, strict=True):
        assert b.of_face.tolist() == a.of_face[keep].tolist()


def test_dense_rows():
    index = np.array([1, -1, 0])
    real = Attribute("a", "vertex", np.array([[1.0], [2.0]], np.float32), index=index)
    whole = Attribute("a", "vertex", np.array([[1], [2]], np.uint8), index=index)
    np.testing.assert_array_equal(real.dense(), np.array([[2], [np.nan], [1]]))
    np.testing.assert_array_equal(whole.dense(), [[2], [0], [1]])
    assert (real.dense().dtype, whole.dense().dtype) == (np.float32, np.uint8)


def test_small_faces_are_left_out_and_named():
    mesh = PolyMesh(np.eye(3), np.array([0, 1, 0, 1, 2, 2]), np.array([0, 2, 5, 6]))
    found = checked(mesh)
    assert (found.triangles.tolist(), found.sizes.tolist()) == ([[0, 1, 2]], [3])
    assert found.lost == ("2 faces of fewer than three corners",)


@pytest.mark.parametrize(
    ("corners", "message"),
    [
        ([0, 1, 2, 0, 1, 3], r"face 1 has vertex indices \[0, 1, 3\], outside 0..2"),
        ([0, 1, -1, 0, 1, 2], "face 0 has vertex indices"),
    ],
)
def test_indices_out_of_range_are_refused(corners, message):
    with pytest.raises(MeshError, match=message):
        checked(PolyMesh(np.eye(3), np.array(corners), np.array([0, 3, 6])))


# Words


def test_words_for_what_is_not_kept():
    mesh = polygon((0, 0), (1, 0), (1, 1), (0, 1))
    uv = Attribute("uv", "corner", np.zeros((4, 2)), "uv")
    second = Attribute("uv1", "corner", np.zeros((4, 2)), "uv")
    colour = Attribute("colour", "face", np.zeros((1, 3)), "colour")
    quality = Attribute("quality", "vertex", np.zeros((4, 1)))
    moved = np.eye(4)[None] + 1
    mesh = replace(
        mesh,
        attributes=(uv, second, colour, quality),
        parts=(
            Parts("object", ("o",), np.array([0]), moved),
            Parts("material", ("m",), np.array([0])),
        ),
        metadata={"comments": ("made by",), "mtllib": ("a.mtl",)},
        lost=("lines",),
    )
    assert losses_of(mesh) == (
        "lines",
        "polygons of more than three corners",
        "texture coordinates",
        "texture coordinates (uv1)",
        "colours of faces",
        "quality of vertices",
        "objects",
        "transforms",
        "materials",
        "material libraries",
    )
    kept = losses_of(
        mesh,
        attributes=[uv, quality],
        parts=["object"],
        metadata=["mtllib"],
        polygons=True,
        transforms=True,
    )
    assert kept == ("lines", "texture coordinates (uv1)", "colours of faces", "materials")
    assert losses_of(from_triangles(np.eye(3), np.array([[0, 1, 2]]))) == ()


def test_words_for_attributes():
    def words(name, domain, role):
        return describe_attribute(Attribute(name, domain, np.zeros((1, 3)), role))

    assert words("normal", "vertex", "normal") == words("normal", "corner", "normal") == "normals"
    assert words("colour", "vertex", "colour") == "colours"
    assert words("colour", "corner", "colour") == "colours of corners"
    assert words("flags", "face", "other") == "flags of faces"
