"""Originals with the vertices and faces of what was decoded of them."""

from __future__ import annotations

import meshes
import numpy as np

from deltamesh import decode, encode
from deltamesh._compare.likeness import corresponding
from deltamesh._page.alignment import aligned, shown
from deltamesh_formats.polymesh.mesh import Attribute, PolyMesh, from_triangles

V, F = meshes.icosphere(2)


def test_vertices_are_those_of_the_decoded_mesh() -> None:
    original = from_triangles(V, F)
    mesh = decode(encode(original, method="cartesian", bits=8))
    match = corresponding(original, mesh)
    assert match is not None
    found = aligned(mesh, match)
    np.testing.assert_array_equal(found.corners, mesh.corners)
    error = np.abs(found.vertices - mesh.vertices)
    assert 0 < error.max() < 2 / 255
    assert {*map(tuple, found.vertices)} == {*map(tuple, V)}


def test_a_page_file_of_it_has_the_same_order() -> None:
    original = from_triangles(V[:, ::-1].copy(), F)
    mesh = decode(encode(original, bits=6))
    match = corresponding(original, mesh)
    assert match is not None
    held = decode(encode(aligned(mesh, match), method="cartesian", bits=20, keep_order=True))
    np.testing.assert_array_equal(held.corners, mesh.corners)
    np.testing.assert_array_equal(held.offsets, mesh.offsets)


def test_isolated_vertices_stay_where_they_are() -> None:
    far = np.array([[9.0, 9, 9]])
    original = from_triangles(V, F)
    mesh = from_triangles(np.concatenate([V + 1e-3, far]), F)
    match = corresponding(original, mesh)
    assert match is not None
    found = aligned(mesh, match)
    np.testing.assert_array_equal(found.vertices[:-1], V)
    np.testing.assert_array_equal(found.vertices[-1], far[0])


def test_only_what_is_shown_is_kept() -> None:
    n = len(V)
    attributes = (
        Attribute("c", "vertex", np.zeros((n, 3), np.uint8), "colour"),
        Attribute("heat", "vertex", np.zeros((n, 1)), "other"),
        Attribute("uv", "vertex", np.zeros((n, 2)), "uv"),
    )
    mesh = PolyMesh(
        V, F.ravel(), np.arange(0, F.size + 1, 3), attributes, (), {"comments": ("long",)}
    )
    found = shown(mesh)
    assert [one.name for one in found.attributes] == ["c", "uv"]
    assert (found.metadata, found.lost) == ({}, ())
