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


# Triangles


def fan(corners: list[int], middle: int) -> list[tuple[int, int, int]]:
    turned = corners[middle:] + corners[:middle]
    return [(turned[0], turned[i], turned[i + 1]) for i in range(1, len(corners) - 1)]


def slow_triangles(mesh: PolyMesh) -> list[tuple[int, int, int]]:
    """Polygon by polygon, the fans of all its corners one after the other."""
    found = []
    for begin, end in zip(mesh.offsets[:-1], mesh.offsets[1:], strict=True):
        corners = mesh.corners[begin:end].tolist()

        def score(middle: int, corners: list[int] = corners) -> float:
            V = mesh.vertices
            faces = fan(corners, middle)
            normals = [np.cross(V[b] - V[a], V[c] - V[a]) for a, b, c in faces]
            return min(float(n @ np.sum(normals, axis=0)) for n in normals)

        scores = [score(i) for i in range(len(corners))]
        middle = 0 if scores[0] > 0 or len(corners) > 16 else int(np.argmax(scores))
        found += fan(corners, middle)
    return found


@given(st.data(), st.integers(0, 10**6))
def test_triangles_are_the_slow_ones(data, seed):
    """On a grid of whole numbers, where sums are exact and ties are ties."""
    rng = np.random.default_rng(seed)
    sizes = data.draw(st.lists(st.integers(3, 20), min_size=1, max_size=6))
    vertices = rng.integers(-4, 5, size=(12, 3)).astype(float)
    offsets = np.concatenate(([0], np.cumsum(sizes)))
    mesh = PolyMesh(vertices, rng.integers(0, 12, size=sum(sizes)), offsets)
    cut = mesh.triangulation()
    assert list(map(tuple, cut.faces.tolist())) == slow_triangles(mesh)
    np.testing.assert_array_equal(mesh.corners[cut.corners], cut.faces)
    np.testing.assert_array_equal(
        cut.polygon, np.repeat(np.arange(len(sizes)), np.array(sizes) - 2)
    )
    np.testing.assert_array_equal(mesh.triangles, cut.faces)
    within = (cut.corners >= offsets[cut.polygon, None]) & (
        cut.corners < offsets[cut.polygon + 1, None]
    )
    assert within.all()


def test_convex_polygons_are_fans_of_their_first_corner():
    assert polygon((0, 0), (1, 0), (1, 1), (0, 1)).triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    around = 2 * np.pi * np.arange(7) / 7
    mesh = polygon(*zip(np.cos(around), np.sin(around), strict=True))
    assert mesh.triangles.tolist() == [[0, i, i + 1] for i in range(1, 6)]


def test_reflex_corners_do_not_fold():
    arrow = [(0, 0), (2, -1), (0.5, 0), (2, 1)]
    for turn in range(4):
        mesh = polygon(*np.roll(arrow, turn, axis=0))
        a, b, c = mesh.vertices[mesh.triangles].transpose(1, 0, 2)
        assert (np.cross(b - a, c - a)[:, 2] > 0).all()


def test_corners_in_line_make_no_sliver_where_that_can_be():
    mesh = polygon((0, 0), (1, 0), (2, 0), (2, 2))
    assert mesh.triangles.tolist() == [[1, 2, 3], [1, 3, 0]]


@pytest.mark.parametrize("scale", [1e-200, 1e200, np.nan])
def test_any_numbers_make_triangles(scale):
    mesh = polygon((0, 0), (2, -1), (0.5, 0), (2, 1))
    cut = replace(mesh, vertices=mesh.vertices * scale).triangulation()
    assert sorted(cut.faces.ravel().tolist()) in ([0, 0, 1, 2, 2, 3], [0, 1, 1, 2, 3, 3])


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
