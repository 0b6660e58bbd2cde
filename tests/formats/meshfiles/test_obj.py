"""OBJ: every form of its statements, and what is no OBJ."""

from __future__ import annotations

import numpy as np
import pytest
from filetests import again, exact, named, polygons, read, refused, rows

from deltamesh_formats.meshfiles.files import mesh_bytes, written
from deltamesh_formats.polymesh.mesh import Attribute, Parts, from_triangles

CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
SQUARE = CORNERS + "v 1 1 0\n"


@pytest.mark.parametrize(
    ("text", "faces"),
    [
        (CORNERS + "f 1 2 3", [[0, 1, 2]]),
        (CORNERS.replace("\n", "\r\n") + "f 1 2 3\r\n", [[0, 1, 2]]),
        (CORNERS.replace("\n", "\r") + "f 1 2 3\r", [[0, 1, 2]]),
        (CORNERS + "f 1 2 \\\n3\n", [[0, 1, 2]]),
        (CORNERS + "f 1 2 \\\r\n\\\r\n3\n", [[0, 1, 2]]),
        ("# C:\\\n" + CORNERS + "f 1 2 3", [[0, 1, 2]]),
        ("\n\n" + CORNERS.replace("v ", "v\t") + "\n  f\t3 2   1 \n\n", [[2, 1, 0]]),
        ("# f 3 2 1\n \n" + CORNERS + "f 1 2 3\n", [[0, 1, 2]]),
        (CORNERS + "fo 1 2 3\n", [[0, 1, 2]]),
        (CORNERS + "f -3 -2 -1\nv 7 7 7\nf -4 -1 2\n", [[0, 1, 2], [0, 3, 1]]),
        (SQUARE + "f 1 2 4 3\nf 1 2 3\nf 4 3 1 2", [[0, 1, 3, 2], [0, 1, 2], [3, 2, 0, 1]]),
        (SQUARE + "v 2 2 2\nf 1 2 3 4 5\n", [[0, 1, 2, 3, 4]]),
        ("f 1 2 3\n" + CORNERS, [[0, 1, 2]]),
    ],
)
def test_faces(text, faces):
    mesh = read(text, "obj")
    assert polygons(mesh) == faces
    np.testing.assert_array_equal(mesh.vertices[:3], [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert len(mesh.vertices) == text.count("v ") + text.count("v\t")
    assert (mesh.attributes, mesh.parts, mesh.lost) == ((), (), ())


TABLES = SQUARE + "vt 0 0\nvt 1 0.5\nvn 0 0 1\nvn 1 0 0\nvn 0 1 0\n"


@pytest.mark.parametrize(
    ("face", "uv", "normal"),
    [
        ("1/1 2/2 3/1", [0, 1, 0], None),
        ("1/1/ 2/2/ 3/1/", [0, 1, 0], None),
        ("1//1 2//3 3//2", None, [0, 2, 1]),
        ("1/1/1 2/2/3 3/1/2", [0, 1, 0], [0, 2, 1]),
        ("-4/-2/-3 -3/-1/-1 -2/-2/-2", [0, 1, 0], [0, 2, 1]),
        ("1/1/1 2//3 3", [0, -1, -1], [0, 2, -1]),
    ],
)
def test_indices_of_their_own(face, uv, normal):
    """The tables stay as they are, rows that no corner uses with them."""
    mesh = read(f"{TABLES}f {face}\n", "obj")
    for role, index, table in (("uv", uv, [[0, 0], [1, 0.5]]), ("normal", normal, np.eye(3))):
        found = mesh.attribute(role, "corner")
        if index is None:
            assert found is None
            assert any("that no face refers to" in words for words in mesh.lost)
        else:
            assert found.index.tolist() == index
            np.testing.assert_array_equal(found.values, np.roll(table, role == "normal", axis=0))
    if uv and normal:
        back = again(mesh, "obj")
        for a, b in zip(mesh.attributes, back.attributes, strict=True):
            np.testing.assert_array_equal(a.index, b.index)
            np.testing.assert_array_equal(a.values, b.values)


def test_a_row_for_each_vertex_is_of_vertices():
    mesh = read(
        CORNERS + "vn 0 0 1\nvn 1 0 0\nvn 0 1 0\nf 1//1 2//2 3//3\nf 3//3 2//2 1//1\n", "obj"
    )
    assert rows(mesh, "normal", "vertex") == [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    assert b"f 3//3 2//2 1//1" in mesh_bytes(mesh, "obj")


def test_texture_coordinates_of_one_to_three_numbers():
    mesh = read(CORNERS + "vt 0.5\nvt 1 2\nvt 1 2 3\nf 1/1 2/2 3/3\n", "obj")
    assert rows(mesh, "uv", "vertex") == [[0.5, 0, 0], [1, 2, 0], [1, 2, 3]]


def test_colours_and_weights_of_vertices():
    mesh = read("v 0 0 0 1 0.5 0\nv 1 0 0\nv 0 1 0 nan 0 0\nf 1 2 3\n", "obj")
    colours = rows(mesh, "colour", "vertex")
    assert (colours[0], colours[1]) == ([1, 0.5, 0], None)
    assert np.isnan(colours[2][0])
    assert read(CORNERS.replace("0 0 0", "0 0 0 1") + "f 1 2 3", "obj").lost == ()
    weighted = read(CORNERS.replace("0 0 0", "0 0 0 2") + "f 1 2 3", "obj")
    assert weighted.lost == ("weights of vertices",)
    np.testing.assert_array_equal(weighted.vertices[0], [0, 0, 0])


NAMED = """
f 1 2 3
o a body
g left  hand
usemtl red#1
s 1
f 3 2 1
g
s off
f 2 1 3
o two # not a comment
usemtl blue
f 1 3 2
o a body
s 0
f 1 2 3
"""


def test_names():
    mesh = read(CORNERS + NAMED, "obj")
    two = "two # not a comment"
    assert named(mesh, "object") == [None, "a body", "a body", two, "a body"]
    assert named(mesh, "group") == [None, "left  hand", None, None, None]
    assert named(mesh, "material") == [None, "red#1", "red#1", "blue", "blue"]
    assert named(mesh, "smoothing") == [None, "1", None, None, None]
    back = again(mesh, "obj")
    for kind in ("object", "group", "material", "smoothing"):
        assert named(back, kind) == named(mesh, kind)


def test_names_in_any_encoding_come_back():
    data = b"# Gr\xf6\xdfe\nmtllib \xe9.mtl\no \xff\n" + CORNERS.encode() + b"f 1 2 3\n"
    mesh = read(data, "obj")
    assert mesh.metadata["comments"] == (" Gr\udcf6\udcdfe",)
    written_ = mesh_bytes(mesh, "obj")
    assert b"mtllib \xe9.mtl\n" in written_
    assert b"\no \xff\n" in written_


def test_objects_of_one_name_stay_apart():
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]] * 4))
    parts = Parts("object", ("x", "", "x", ""), np.arange(4))
    mesh = type(mesh)(mesh.vertices, mesh.corners, mesh.offsets, parts=(parts,))
    assert named(again(mesh, "obj"), "object") == ["x", "object_2", "x_2", "object_3"]


def test_what_has_no_place_is_named():
    text = CORNERS + "vp 0 1\np 1\nl 1 2\nlod 3\nwhat 1\nf 1 2\nf 1 2 3\nvt 0 0\n"
    mesh = read(text, "obj")
    assert polygons(mesh) == [[0, 1, 2]]
    assert mesh.lost == (
        "texture coordinates that no face refers to",
        "points",
        "lines",
        "free-form geometry",
        "display settings",
        "statements unknown to OBJ ('what')",
        "1 faces of fewer than three corners",
    )


def test_what_obj_has_no_place_for():
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    quality = Attribute("quality", "vertex", np.zeros((3, 1)))
    shade = Attribute("colour", "face", np.zeros((1, 3)), "colour")
    mesh = type(mesh)(mesh.vertices, mesh.corners, mesh.offsets, (quality, shade))
    assert written(mesh, "obj").lost == ("quality of vertices", "colours of faces")


def test_colours_in_bytes_become_fractions():
    colour = Attribute("colour", "vertex", np.array([[255, 0, 51]] * 3, "u1"), "colour", None, True)
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    mesh = type(mesh)(mesh.vertices, mesh.corners, mesh.offsets, (colour,))
    assert rows(again(mesh, "obj"), "colour", "vertex") == [[1, 0, 0.2]] * 3


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no vertices and no faces"),
        ("# nothing\n", "no vertices and no faces"),
        ("cstype bezier\n", exact("no vertices and no faces (and free-form geometry)")),
        (CORNERS, "3 vertices but no faces: a point cloud"),
        (CORNERS + "p 1 2 3\n", exact("a point cloud (and points)")),
        (CORNERS + "f 1 2 4\n", "line 4: a face refers to vertex 4, of 3"),
        (TABLES + "f 1/1 2/3 3/1\n", "line 10: a face refers to texture coordinate 3, of 2"),
        (TABLES + "f 1//1 2//-4 3//1\n", "line 10: a face refers to normal -4, of 3"),
        (CORNERS + "f 0 1 2\n", "line 4: a face has the vertex index 0, but OBJ counts from 1"),
        (CORNERS + "f -4 -2 -1\n", "line 4: a face refers to vertex -4, of 3"),
        (CORNERS + "f 99999999999999999999 1 2\n", "line 4: a face refers to vertex"),
        (CORNERS + "f 1 2\n", exact("a set of lines (and 1 faces of fewer than three corners)")),
        (CORNERS + "f 1 two 3\n", "line 4: 'two' is not a whole number"),
        (CORNERS + "f 1 2 3.5\n", "line 4: '3.5' is not a whole number"),
        (CORNERS + "f 1 2-3 3\n", "line 4: '2-3' is not a whole number"),
        (CORNERS + "f 1 2 /3\n", "line 4: '/3' names no vertex"),
        (CORNERS + "f 1 2 /\n", "line 4: '/' names no vertex"),
        (CORNERS + "f 1 2 3/1/1/1\n", "line 4: '3/1/1/1' is not of the form v/vt/vn"),
        (CORNERS + "\n\nv 1 nonsense 2\nf 1 2 3\n", "line 6: 'nonsense' is not a number"),
        (CORNERS + "v 1 0x2 2\nf 1 2 3\n", "line 4: '0x2' is not a number"),
        (CORNERS + "v 1 2-3 2\nf 1 2 3\n", "line 4: '2-3' is not a number"),
        (CORNERS + "v 1 2\nf 1 2 3\n", "line 4: a vertex of 2 numbers"),
        (CORNERS + "v\nf 1 2 3\n", "line 4: a vertex of 0 numbers"),
        (CORNERS + "vn 1 2\nf 1 2 3\n", "line 4: a normal of 2 numbers"),
        (CORNERS + "vt 1 2 3 4\nf 1 2 3\n", "line 4: a texture coordinate of 4 numbers"),
        (CORNERS + "v 0 nan 0\nf 1 2 3\n", "vertex 3 is not finite"),
        (CORNERS + "v 0 1e999 0\nf 1 2 3\n", "vertex 3 is not finite"),
        ("f 1 2 3\n", "line 1: a face refers to vertex 1, of 0"),
        (CORNERS + "f 1 2\0 3\n", "line 4: .* is not a whole number"),
    ],
)
def test_malformed(text, message):
    refused(text, "obj", message)
