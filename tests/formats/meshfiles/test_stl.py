"""STL: vertices that are one again, solids, and what is no STL."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from filetests import POINTS, again, named, polygons, read, refused

from deltamesh_formats.meshfiles.files import mesh_bytes, written
from deltamesh_formats.polymesh.mesh import Attribute, Parts, from_triangles

FACET = "facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n"
CORNERS = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
ONE = FACET.format(CORNERS)
OTHER = FACET.format("vertex 0 1 0\nvertex 1 0 0\nvertex -0.0 0 2.5e-1\n")
MESH = from_triangles(np.array(POINTS, dtype=float), np.array([[2, 1, 3], [0, 1, 2]]))


def test_vertices_at_one_position_are_one():
    for data in (f"solid\n{ONE}{OTHER}endsolid\n".encode(), mesh_bytes(MESH, "stl")):
        mesh = read(data, "stl")
        assert polygons(mesh)[0] == [0, 1, 2]
        assert len(mesh.vertices) == 4
        assert mesh.parts == ()
    # Numbered as they come first; -0.0 is at 0.0.
    touching = read(f"solid\n{ONE}{OTHER.replace('2.5e-1', '0')}endsolid\n", "stl")
    assert polygons(touching) == [[0, 1, 2], [2, 1, 0]]


@pytest.mark.parametrize("normal", ["0 0 1", "0 0 0", "0 0 7", "0.1 0 1"])
def test_normals_that_follow_from_positions_need_no_word(normal):
    text = f"solid\n{ONE.replace('0 0 1', normal)}endsolid"
    assert read(text, "stl").lost == ()


@pytest.mark.parametrize("normal", [[0, 0, -1], [1, 0, 1], [0, 1, 0]])
def test_other_normals_are_named_as_lost(normal):
    words = ("normals that are not those of their facets",)
    text = f"solid\n{ONE}{ONE.replace('0 0 1', ' '.join(map(str, normal)))}endsolid"
    assert read(text, "stl").lost == words
    data = bytearray(mesh_bytes(MESH, "stl"))
    assert read(bytes(data), "stl").lost == ()
    data[84:96] = np.array(normal, dtype="<f4").tobytes()
    assert read(bytes(data), "stl").lost == words
    # A sliver has no normal to speak of.
    sliver = ONE.replace("vertex 0 1 0", "vertex 2 1e-5 0").replace("0 0 1", "0 1 0")
    assert read(f"solid\n{sliver}endsolid", "stl").lost == ()


def test_solids():
    text = f"solid a vertex\n{ONE}{OTHER}endsolid a vertex\nsolid \xe9 facet\n{ONE}endsolid\n"
    text += "solid nothing\nendsolid\nsolid\n" + ONE + "endsolid"
    names = ["a vertex", "a vertex", "\udce9 facet", ""]
    for data in (text.encode("latin-1"), text.replace("\n", "\r\n").encode("latin-1")):
        mesh = read(data, "stl")
        assert named(mesh, "object") == names
        assert named(again(mesh, "stl"), "object") == names
        np.testing.assert_array_equal(again(mesh, "stl").vertices, mesh.vertices)
    upper = read(text.upper().encode("latin-1").replace(b"\n", b"\r"), "stl")
    np.testing.assert_array_equal(upper.vertices, mesh.vertices)
    assert b"solid \xe9 facet\n" in mesh_bytes(mesh, "stl")


def test_a_solid_alone_with_its_name():
    mesh = read(f"solid part 7\n{ONE}endsolid part 7\n", "stl")
    assert named(mesh, "object") == ["part 7"]
    assert mesh_bytes(mesh, "stl").startswith(b"solid part 7\n")


def test_binary_that_says_solid():
    data = b"solid facet" + mesh_bytes(MESH, "stl")[11:]
    mesh = read(data, "stl")
    assert len(mesh.faces) == 2
    assert mesh.metadata["header"] == ("solid facet",)
    assert mesh_bytes(mesh, "stl") == data


def test_bytes_of_facets_without_a_meaning_are_none():
    assert read(mesh_bytes(MESH, "stl"), "stl").attributes == ()


def test_normals_are_those_of_the_facets():
    facets = np.frombuffer(mesh_bytes(MESH, "stl"), "<f4", offset=84, count=3)
    a, b, c = MESH.vertices[MESH.faces[0]]
    normal = np.cross(b - a, c - a)
    np.testing.assert_allclose(facets, normal / np.linalg.norm(normal), rtol=1e-6)
    tiny = replace(MESH, vertices=MESH.vertices * 1e-30, precision="float64")
    np.testing.assert_array_equal(
        np.frombuffer(mesh_bytes(tiny, "stl"), "<f4", offset=84, count=3), facets
    )
    flat = from_triangles(np.zeros((3, 3)), np.array([[0, 1, 2]]))
    assert not any(mesh_bytes(flat, "stl")[84:96])
    parts = (Parts("object", ("huge",), np.array([0, 0])),)
    huge = replace(MESH, vertices=MESH.vertices * 1e307 - 1e308, parts=parts)
    np.testing.assert_array_equal(again(huge, "stl").vertices, huge.vertices[[2, 1, 3, 0]])


def test_objects_become_solids_whatever_the_order_of_faces():
    faces = np.array([[0, 1, 2], [2, 1, 3], [0, 2, 3]])
    parts = Parts("object", ("a", "b"), np.array([1, 0, -1]))
    mesh = replace(from_triangles(MESH.vertices, faces), parts=(parts,))
    back = again(mesh, "stl")
    assert named(back, "object") == ["", "a", "b"]
    np.testing.assert_array_equal(back.vertices[back.faces], MESH.vertices[faces[[2, 1, 0]]])


def test_what_has_no_place_is_named():
    vertices = np.append(MESH.vertices, [[7, 7, 7]], axis=0)
    mesh = from_triangles(vertices, MESH.faces[:0])
    colour = Attribute("colour", "face", np.zeros((1, 3)), "colour")
    mesh = replace(
        mesh, corners=np.array([0, 1, 3, 2]), offsets=np.array([0, 4]), attributes=(colour,)
    )
    words = ("polygons of more than three corners", "colours of faces", "vertices of no face")
    assert written(mesh, "stl").lost == words


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "neither an ASCII STL nor a binary one"),
        (b"solid nothing\nendsolid nothing\n", "no vertices and no faces"),
        (bytes(84), "no vertices and no faces"),
        (mesh_bytes(MESH, "stl")[:-1], "header of 2 facets would mean 184 bytes: it has 183"),
        (mesh_bytes(MESH, "stl") + bytes(50), "counts 2 facets, but it has the length of 3"),
        (f"solid\n{ONE[:-9]}\nendsolid", "its last facet has no end: is it cut short"),
        (f"solid\n{ONE}endsolid\nfacet\nendsolid", "its last facet has no end: is it cut short"),
        (
            f"solid\n{FACET.format(CORNERS[:26])}endsolid",
            "line 6: 'endloop' where 'vertex' belongs",
        ),
        (f"solid\n{FACET.format(CORNERS + CORNERS)}endsolid", "line 7: 'vertex' where 'endloop'"),
        (
            f"solid\n{ONE.replace('vertex 1', 'vertex one')}endsolid",
            "line 5: 'one' is not a number",
        ),
        (f"solid\n{ONE.replace('vertex 1', 'vertex nan')}endsolid", "vertex 1 is not finite"),
        (f"solid\n{ONE.replace('vertex 1 0', 'vertex 1')}endsolid", "where 'vertex' belongs"),
    ],
)
def test_malformed(data, message):
    refused(data, "stl", message)
