"""OFF: text by lines or not, colours, the binary forms, and what is no OFF."""

from __future__ import annotations

import itertools
import struct
from dataclasses import replace

import numpy as np
import pytest
from filetests import POINTS, again, polygons, read, refused, rows

from deltamesh_formats.meshfiles.files import mesh_bytes, written
from deltamesh_formats.polymesh.mesh import Attribute, from_triangles

OFF = "OFF\n4 2 5\n0 0 0\n1 0 0\n0 1 0\n0.5 0.25 8\n3 0 1 2\n3 2 1 3\n"


@pytest.mark.parametrize(
    "text",
    [
        OFF,
        OFF.replace("OFF\n", "OFF\n# a comment: OFF\n\n"),
        OFF.replace("OFF\n", "OFF "),
        OFF.replace("4 2 5", "4 2"),
        OFF.replace("\n", " \r\n"),
        OFF.replace("\n", "\r"),
        OFF.replace(" ", "\n"),
        OFF.replace("\n", " "),
        OFF.replace("3 0 1 2\n", "3 0\n1\n2 "),
        "\n" + OFF.replace("\n", "\n\n"),
    ],
)
def test_forms_of_text(text):
    mesh = read(text, "off")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    assert polygons(mesh) == [[0, 1, 2], [2, 1, 3]]
    assert (mesh.attributes, mesh.lost) == ((), ())


def test_polygons():
    for text in (OFF.replace("3 0 1 2", "4 0 1 3 2"), OFF.replace("3 0 1 2", "4 0 1\n3 2")):
        assert polygons(read(text, "off")) == [[0, 1, 3, 2], [2, 1, 3]]


@pytest.mark.parametrize("ends", ["\n", " "], ids=["lines", "one row"])
@pytest.mark.parametrize(
    ("keyword", "numbers", "names"),
    [
        ("NOFF", "0 0 1", {"normal": [0, 0, 1]}),
        ("COFF", "255 7 0 255", {"colour": [255, 7, 0, 255]}),
        ("COFF", "1.0 0.5 0.0", {"colour": [1, 0.5, 0]}),
        ("STOFF", "0.5 1", {"uv": [0.5, 1]}),
        ("CNOFF", "0 0 1 0.5 0.5 0.25", {"normal": [0, 0, 1], "colour": [0.5, 0.5, 0.25]}),
        (
            "STCNOFF",
            "0 0 1 1 2 3 4 8 9",
            {"normal": [0, 0, 1], "colour": [1, 2, 3, 4], "uv": [8, 9]},
        ),
    ],
)
def test_attributes_of_vertices(keyword, numbers, names, ends):
    lines = OFF.replace("OFF", keyword).splitlines()
    lines[2:6] = [f"{line}  {numbers}" for line in lines[2:6]]
    mesh = read(ends.join(lines), "off")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    assert polygons(mesh) == [[0, 1, 2], [2, 1, 3]]
    assert {a.name: rows(mesh, a.name, "vertex")[0] for a in mesh.attributes} == names
    bytes_ = "colour" in names and "." not in numbers
    assert [a.normalized for a in mesh.attributes if a.name == "colour"] == [bytes_] * (
        "colour" in names
    )


def test_colours_of_faces():
    text = OFF.replace("4 2 5", "4 5 5").replace("3 0 1 2\n", "3 0 1 2 255 0 0\n")
    text += "3 0 1 2 0.5 0.25 1 1\n3 0 1 2 7\n3 0 1 2 1 2 3 4 5\n"
    mesh = read(text, "off")
    three, four = (a for a in mesh.attributes if a.name == "colour")
    assert (three.values.tolist(), three.normalized) == ([[255, 0, 0]], True)
    assert three.rows().tolist() == [0, -1, -1, -1, -1]
    assert (four.values.tolist(), four.normalized) == ([[0.5, 0.25, 1, 1]], False)
    assert rows(mesh, "colour_index", "face") == [None, None, None, [7], None]
    assert mesh.lost == ("numbers after faces that are not colours",)


def test_whole_numbers_that_are_fractions_stay_fractions():
    colour = Attribute("colour", "face", np.array([[1.0, 0.0, 1.0]] * 2), "colour")
    back = again(replace(read(OFF, "off"), attributes=(colour,)), "off")
    assert back.attributes[0].values.dtype == float
    assert rows(back, "colour", "face") == [[1, 0, 1]] * 2


def test_what_has_no_place_is_named():
    text = OFF.replace("0 1 0\n", "0 1 0 7\n")
    refused(text, "off", "do not fit")
    lines = OFF.splitlines()
    lines[2:6] = [f"{line} 7 8" for line in lines[2:6]]
    assert read("\n".join([*lines, "1 2", "3"]), "off").lost == (
        "2 more numbers of each vertex",
        "2 lines after the last face",
    )
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    uv = Attribute("uv", "corner", np.zeros((3, 2)), "uv")
    assert written(replace(mesh, attributes=(uv,)), "off").lost == ("texture coordinates",)


def test_comments():
    text = "# first\n" + OFF.replace("OFF\n", "OFF\n#second \xe4\n # third\n") + "# last\n"
    mesh = read(text.encode("latin-1"), "off")
    assert mesh.metadata["comments"] == (" first", "second \udce4", " third")
    assert b"#second \xe4\n" in mesh_bytes(mesh, "off")


FACES = [[0, 1, 2], [2, 1, 3, 0]]


def binary(order, *, counts=True, colours=None, keyword="OFF", points=POINTS):
    data = f"{keyword} BINARY\n".encode() + struct.pack(order + "3i", len(points), 2, 0)
    data += b"".join(struct.pack(f"{order}{len(p)}f", *p) for p in points)
    for face, colour in zip(FACES, colours or [[], []], strict=True):
        data += struct.pack(f"{order}{len(face) + 1}i", len(face), *face)
        if counts:
            data += struct.pack(f"{order}i{len(colour)}f", len(colour), *colour)
    return data


@pytest.mark.parametrize(("order", "counts"), list(itertools.product("<>", (True, False))))
def test_binary(order, counts):
    mesh = read(binary(order, counts=counts), "off")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    assert polygons(mesh) == FACES
    assert mesh.precision == "float32"


@pytest.mark.parametrize("order", "<>")
def test_binary_with_attributes(order):
    points = [[*p, 0, 0, 1] for p in POINTS]
    colours = [[0.5, 0.25, 1], []]
    mesh = read(binary(order, keyword="NOFF", colours=colours, points=points), "off")
    assert rows(mesh, "normal", "vertex") == [[0, 0, 1]] * 4
    assert rows(mesh, "colour", "face") == [[0.5, 0.25, 1], None]
    odd = read(binary(order, colours=[[0.5, 0.25, 1], [1, 1, 1, 1]]), "off")
    assert odd.lost == ("colours of faces, whose components differ in number",)


@pytest.mark.parametrize(("order", "counts"), list(itertools.product("<>", (True, False))))
def test_half_a_binary_is_refused(order, counts):
    data = binary(order, counts=counts)
    for size in range(data.index(b"\n") + 1, len(data)):
        refused(data[:size], "off")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "does not begin with 'OFF'"),
        ("OFFICE", "does not begin with 'OFF'"),
        ("4OFF\n0 0 0\n", "do not have three coordinates"),
        ("nOFF\n3\n0 0 0\n", "do not have three coordinates"),
        ("OFF\n4 2", "cut short"),
        ("OFF\n", "no counts"),
        ("OFF BINARY\n\0\0", "in either byte order: is it cut short"),
        ("OFF\n0 0 0\n", "no vertices and no faces"),
        ("OFF\n3 0 0\n0 0 0\n1 1 1\n2 2 2\n", "a point cloud"),
        (OFF[:-9], "is it cut short"),
        (OFF[:-3], "is it cut short"),
        (OFF.replace("4 2 5", "4 3 5"), "is it cut short"),
        (OFF.replace("4 2 5", "999999999999 2 5"), "is it cut short"),
        (OFF.replace("4 2 5", "-4 2 5"), "no counts"),
        (OFF.replace("2 1 3", "2 1 4"), r"face 1 has vertex indices \[2, 1, 4\], outside 0..3"),
        (OFF.replace("2 1 3", "2 1 -1"), "face 1 has vertex indices"),
        (OFF.replace("2 1 3", "2 1 2.5"), "line 8: '2.5' is not a vertex index"),
        (OFF.replace("2 1 3", "2 1 1e300"), "line 8: '1e300' is not a vertex index"),
        (OFF.replace("2 1 3", "2 1 nan"), "line 8: 'nan' is not a vertex index"),
        (OFF.replace("0.5", "half"), "line 6: 'half' is not a number"),
        (OFF.replace("0.5", "inf"), "vertex 3 is not finite"),
    ],
)
def test_malformed(text, message):
    refused(text, "off", message)
