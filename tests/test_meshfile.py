"""Mesh files: what is written comes back, what is malformed is refused, nothing else is changed."""

from __future__ import annotations

import io
import json
import os
import struct
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from deltamesh_formats import meshfile
from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfile import FORMATS, mesh_bytes, mesh_format, read_mesh, write_mesh

MESHES = Path(os.environ.get("DELTAMESH_MESHES", Path(__file__).parents[2] / "shared" / "meshes"))

# Numbers without an end in binary, and magnitudes that a fixed number of decimals would lose;
# vertices 2 and 5 are isolated, vertex 4 repeats vertex 0.
V = np.array(
    [
        [1 / 3, -2 / 7, 1e-17],
        [np.pi * 1e9, 0.1, -1e-300],
        [5.0, 5.0, 5.0],
        [0.0, -1 / 9, 2.0**-40],
        [1 / 3, -2 / 7, 1e-17],
        [9.0, 9.0, 9.0],
    ]
)
F = np.array([[3, 1, 0], [0, 1, 4], [4, 3, 0]])
ROUNDED = V.astype(np.float32).astype(np.float64)


def read(data, file_format):
    return read_mesh(io.BytesIO(data), file_format)


def refused(data, file_format, message=None):
    with pytest.raises(MeshError, match=message) as caught:
        read(data, file_format)
    assert "<stream>" in str(caught.value)


# Round trips


@pytest.mark.parametrize("file_format", FORMATS)
def test_round_trip(file_format, tmp_path):
    path = tmp_path / f"mesh.{file_format.upper()}"
    vertices, faces = V.copy(), F.copy()
    write_mesh(path, vertices, faces)
    np.testing.assert_array_equal(vertices, V)
    np.testing.assert_array_equal(faces, F)

    mesh = read_mesh(path)
    assert (mesh.format, mesh.vertices.dtype, mesh.faces.dtype) == (file_format, float, np.int64)
    assert mesh.vertices.flags.c_contiguous
    assert mesh.faces.flags.c_contiguous
    if file_format == "stl":
        np.testing.assert_array_equal(mesh.faces, np.arange(9).reshape(3, 3))
        np.testing.assert_array_equal(mesh.vertices, ROUNDED[F].reshape(-1, 3))
    else:
        np.testing.assert_array_equal(mesh.faces, F)
        np.testing.assert_array_equal(mesh.vertices, ROUNDED if file_format == "glb" else V)


@pytest.mark.parametrize("file_format", FORMATS)
def test_files_and_paths_are_alike(file_format, tmp_path):
    path, stream = tmp_path / f"mesh.{file_format}", io.BytesIO()
    write_mesh(str(path), V, F)
    write_mesh(stream, V, F, file_format)
    assert path.read_bytes() == stream.getvalue() == mesh_bytes(V, F, file_format)
    with path.open("rb") as file:
        named = read_mesh(file)
    np.testing.assert_array_equal(named.vertices, read_mesh(path).vertices)


finite = st.floats(allow_nan=False, allow_infinity=False)


@settings(deadline=None)
@given(st.lists(st.tuples(finite, finite, finite), min_size=3, max_size=6), st.data())
def test_float64_survives(vertices, data):
    index = st.integers(0, len(vertices) - 1)
    faces = np.array(data.draw(st.lists(st.tuples(index, index, index), min_size=1, max_size=4)))
    for file_format in ("obj", "ply", "off"):
        mesh = read(mesh_bytes(np.array(vertices), faces, file_format), file_format)
        np.testing.assert_array_equal(mesh.vertices, vertices)
        np.testing.assert_array_equal(mesh.faces, faces)


@pytest.mark.parametrize("file_format", ["stl", "glb"])
def test_float32_overflow_is_refused(file_format):
    with pytest.raises(MeshError, match="float32"):
        mesh_bytes(V * 1e200, F, file_format)


@pytest.mark.parametrize("file_format", FORMATS)
def test_a_mesh_without_faces_is_not_written(file_format):
    with pytest.raises(MeshError, match="without faces"):
        mesh_bytes(V, F[:0], file_format)


# Names and formats


def test_format_by_name():
    assert mesh_format("a.b/c.PLY") == "ply"
    assert mesh_format(Path("x.obj")) == "obj"
    assert mesh_format("x.obj", "OFF") == mesh_format("x", ".off") == "off"


@pytest.mark.parametrize(
    ("name", "file_format", "message"),
    [
        ("a.gltf", None, "a.gltf: 'gltf' is not a mesh format known here: obj, ply, off, stl, glb"),
        ("a.obj", "step", "'step' is not a mesh format"),
        ("noname", None, "noname: .* give one of obj, ply, off, stl, glb"),
        (io.BytesIO(), None, "<stream>: .* give one of obj, ply, off, stl, glb"),
    ],
)
def test_unknown_formats(name, file_format, message):
    for attempt in (lambda: read_mesh(name, file_format), lambda: write_mesh(name, V, F, "x")):
        with pytest.raises(MeshError, match=r"not a mesh format|give one of"):
            attempt()
    with pytest.raises(MeshError, match=message):
        mesh_format(name, file_format)


def test_other_errors_pass(tmp_path, monkeypatch):
    with pytest.raises(FileNotFoundError):
        read_mesh(tmp_path / "absent.ply")
    with pytest.raises(FileNotFoundError):
        write_mesh(tmp_path / "absent" / "mesh.ply", V, F)
    for error in (MemoryError, KeyboardInterrupt, OSError):

        def fail(data, error=error):
            raise error

        monkeypatch.setitem(meshfile._READERS, "ply", fail)
        with pytest.raises(error):
            read(b"", "ply")


def test_importing_is_cheap():
    code = "import sys, deltamesh_formats.meshfile; sys.exit('trimesh' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# OBJ

TRIANGLE = np.array([[0, 1, 2]])
CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
SQUARE = CORNERS + "v 1 1 0\n"


@pytest.mark.parametrize(
    ("text", "faces"),
    [
        (CORNERS + "f 1 2 3", [[0, 1, 2]]),
        (CORNERS.replace("\n", "\r\n") + "f 1 2 3\r\n", [[0, 1, 2]]),
        (CORNERS + "f 1 2 \\\n3\n", [[0, 1, 2]]),
        (CORNERS.replace("v ", "v\t") + "  f\t3 2   1 \n", [[2, 1, 0]]),
        (CORNERS + "# f 3 2 1\nf 1 2 3 # four\n", [[0, 1, 2]]),
        (CORNERS + "f 1//1 2//1 3//1\n", [[0, 1, 2]]),
        (CORNERS + "vt 0 0\nvt 1 1\nf 1/1 2/1 3/2\nf 1/2 3/2 2/1\n", [[0, 1, 2], [0, 2, 1]]),
        (CORNERS + "usemtl b\nf 1 2 3\nusemtl a\nf 3 2 1\nusemtl b\nf 2 1 3\n", "in order"),
        (CORNERS + "o x\ng y\nf 1 2 3\no z\ns 1\nf 3 2 1\nf 2 1 3\n", "in order"),
        (CORNERS + "f -3 -2 -1\nv 7 7 7\nf -4 -1 2\n", [[0, 1, 2], [0, 3, 1]]),
        (SQUARE + "f 1 2 4 3\nf 4 3 1 2\n", [[0, 1, 3], [0, 3, 2], [3, 2, 0], [3, 0, 1]]),
        (SQUARE + "f 1 2 3\nf 1 2 4 3\nf 3 2 1", [[0, 1, 2], [0, 1, 3], [3, 2, 0], [2, 1, 0]]),
        (SQUARE + "v 2 2 2\nf 1 2 3 4 5\n", [[0, 1, 2], [0, 2, 3], [0, 3, 4]]),
    ],
)
def test_obj(text, faces):
    mesh = read(text.encode(), "obj")
    if faces == "in order":
        faces = [[0, 1, 2], [2, 1, 0], [1, 0, 2]]
    np.testing.assert_array_equal(mesh.faces, faces)
    np.testing.assert_array_equal(mesh.vertices[:3], [[0, 0, 0], [1, 0, 0], [0, 1, 0]])
    assert len(mesh.vertices) == text.count("v ") + text.count("v\t")


def test_obj_with_seams_keeps_isolated_vertices():
    text = CORNERS + "v 7 7 7\nvt 0 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/1/1\n"
    assert len(read(text.encode(), "obj").vertices) == 4


def test_obj_with_colours_and_any_encoding():
    text = "# Gr\xf6\xdfe\nmtllib \xe9.mtl\nv 0 0 0 1 1 1\nv 1 0 0 nan 0 0\nv 0 1 0\nf 1 2 3\n"
    mesh = read(text.encode("latin-1"), "obj")
    np.testing.assert_array_equal(mesh.vertices, [[0, 0, 0], [1, 0, 0], [0, 1, 0]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "no vertices and no faces"),
        ("# nothing\n", "no vertices and no faces"),
        (CORNERS, "3 vertices but no faces: a point cloud"),
        (CORNERS + "f 1 2 4\n", "index 3"),
        (CORNERS + "f 0 1 2\n", "index 0, but OBJ counts from 1"),
        (CORNERS + "f -4 -2 -1\n", "index 0"),
        (CORNERS + "f 1 2\n", "shape"),
        (CORNERS + "f 1 two 3\n", "not readable as OBJ"),
        (CORNERS + "v 1 nonsense 2\nf 1 2 3\n", "not readable as OBJ"),
        (CORNERS + "v 1 2\nf 1 2 3\n", r"shape \(4, 2\)"),
        ("f 1 2 3\n", "only 0 of its 1 faces|not readable"),
    ],
)
def test_malformed_obj(text, message):
    refused(text.encode(), "obj", message)


# PLY


def ply(encoding, vertices, faces, *, extra="", count="uchar"):
    """Build a PLY of float32 positions as a header and struct formats, ASCII or binary."""
    lines = ["ply", f"format {encoding} 1.0", "comment \xe4", f"element vertex {len(vertices)}"]
    lines += [f"property float {axis}" for axis in "xyz"]
    lines += [f"element face {len(faces)}", f"property list {count} int vertex_indices"]
    header = ("\n".join([*lines, *extra.split("|"), "end_header"]) + "\n").replace("\n\n", "\n")
    if encoding == "ascii":
        rows = [" ".join(map(str, row)) for row in vertices]
        rows += [" ".join(map(str, [len(face), *face])) for face in faces]
        return header.encode("latin-1") + "\n".join([*rows, ""]).encode()
    order = "<" if "little" in encoding else ">"
    body = b"".join(struct.pack(order + "3f", *row) for row in vertices)
    body += b"".join(struct.pack(f"{order}B{len(f)}i", len(f), *f) for f in faces)
    return header.encode("latin-1") + body


ENCODINGS = ["ascii", "binary_little_endian", "binary_big_endian"]
POINTS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.5, 0.25, 8]]


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("face", [[2, 1, 0], [0, 1, 3, 2]], ids=["triangles", "quads"])
def test_ply(encoding, face):
    mesh = read(ply(encoding, POINTS, [face, face[::-1]]), "ply")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    fans = [[f[0], f[i], f[i + 1]] for f in (face, face[::-1]) for i in range(1, len(f) - 1)]
    np.testing.assert_array_equal(mesh.faces, fans)


def test_ply_with_mixed_polygons():
    faces = [[0, 1, 3, 2], [0, 1, 2]]
    mesh = read(ply("ascii", POINTS, faces), "ply")
    assert {tuple(f) for f in mesh.faces.tolist()} == {(0, 1, 3), (3, 2, 0), (0, 1, 2)}
    refused(ply(ENCODINGS[1], POINTS, faces), "ply", "differ in their number of corners")


@pytest.mark.parametrize("where", ["vertex", "face"])
def test_ply_with_texture_is_not_split(where):
    head = "ply\nformat ascii 1.0\nelement vertex 4\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    per_vertex, per_face = (" 0.5 0.5", "") if where == "vertex" else ("", " 6 0 0 1 1 0 1")
    head += "property float s\nproperty float t\n" if per_vertex else ""
    head += "element face 2\nproperty list uchar int vertex_indices\n"
    head += "property list uchar float texcoord\n" if per_face else ""
    rows = [f"{x} {y} {z}{per_vertex}" for x, y, z in POINTS]
    rows += [f"3 0 1 2{per_face}", f"3 2 1 3{per_face[:-1] + '0' if per_face else ''}"]
    mesh = read((head + "end_header\n" + "\n".join(rows)).encode(), "ply")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [2, 1, 3]])


def test_ply_with_edges_is_a_mesh():
    extra = "element edge 1|property int vertex1|property int vertex2"
    data = ply("ascii", POINTS, [[0, 1, 2]], extra=extra) + b"0 1\n"
    mesh = read(data, "ply")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    np.testing.assert_array_equal(mesh.faces, TRIANGLE)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("face", [[0, 1, 2], [0, 1, 3, 2]], ids=["triangles", "quads"])
def test_half_a_ply_is_refused(encoding, face):
    data = ply(encoding, POINTS, [face] * 4)
    # An ASCII file can lose its last number and still be one.
    start, end = data.index(b"end_header") + 11, len(data) - (2 if encoding == "ascii" else 0)
    for size in range(start, end):
        refused(data[:size], "ply", "cut short")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "does not begin with 'ply'"),
        (b"solid", "does not begin with 'ply'"),
        (b"ply\nformat ascii 1.0\nelement ver", "header has no end"),
        (ply("ascii", [], []), "no vertices and no faces"),
        (ply("ascii", POINTS, []), "4 vertices but no faces: a point cloud"),
        (ply(ENCODINGS[1], POINTS, []), "a point cloud"),
        (ply("ascii", POINTS, [[0, 1, 4]]), r"face 0 has vertex indices \[0, 1, 4\], outside 0..3"),
        (ply("ascii", POINTS, [[0, 1, 2], [0, -1, 2]]), "face 1 has vertex indices"),
        (ply("ascii", POINTS, [["a", 1, 2]]), "not readable as PLY"),
        (ply("ascii", POINTS, [[0, 1, 2]]).replace(b"float x", b"quad x"), "not readable as PLY"),
        (ply("ascii", POINTS, [[0, 1, 2]]).replace(b"float x", b"float q"), "not readable as PLY"),
        (ply(ENCODINGS[1], POINTS, [[0, 1, 2]]) + b"\n", "does not fit its header"),
    ],
)
def test_malformed_ply(data, message):
    refused(data, "ply", message)


def test_ply_of_triangle_strips_is_named():
    data = ply("ascii", POINTS, [[0, 1, 2]])
    refused(data.replace(b"element face", b"element tristrips"), "ply", "triangle strips")


# OFF

OFF = "OFF\n4 2 5\n0 0 0\n1 0 0\n0 1 0\n0.5 0.25 8\n3 0 1 2\n3 2 1 3\n"


@pytest.mark.parametrize(
    "text",
    [
        OFF,
        OFF.replace("OFF\n", "OFF # a comment: OFF\n\n"),
        OFF.replace("OFF\n", "OFF "),
        OFF.replace("\n", " \r\n"),
        OFF.replace("3 0 1 2", "3 0 1 2 255 0 0"),
        OFF.replace("OFF", "COFF").replace("0 1 0\n", "0 1 0 255 255 255 1\n"),
        OFF.replace("OFF", "NOFF").replace("0 1 0\n", "0 1 0  0 0 1\n"),
        OFF.replace(" ", "\n"),
        OFF.replace("\n", " "),
        OFF.replace("3 0 1 2\n", "3 0\n1\n2 "),
    ],
)
def test_off(text):
    mesh = read(text.encode(), "off")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [2, 1, 3]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "does not begin with 'OFF'"),
        ("4OFF\n0 0 0\n", "does not begin with 'OFF'"),
        ("OFF\n4 2", "no counts"),
        ("OFF BINARY\n\0\0", "binary OFF is not read"),
        ("OFF\n0 0 0\n", "no vertices and no faces"),
        ("OFF\n3 0 0\n0 0 0\n1 1 1\n2 2 2\n", "a point cloud"),
        (OFF[:-9], "is it cut short"),
        (OFF[:-3], "is it cut short"),
        (OFF.replace("4 2 5", "4 3 5"), "is it cut short"),
        (OFF.replace("4 2 5", "999999999999 2 5"), "is it cut short"),
        (OFF.replace("4 2 5", "-4 2 5"), None),
        (OFF.replace("2 1 3", "2 1 4"), "outside|not readable"),
        (OFF.replace("0.5", "half"), "not readable as OFF"),
    ],
)
def test_malformed_off(text, message):
    refused(text.encode(), "off", message)


# STL

FACET = "facet normal 0 0 1\nouter loop\n{}endloop\nendfacet\n"
CORNER_LINES = "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"


def test_stl_of_several_solids_stays_soup():
    facet = FACET.format(CORNER_LINES)
    text = f"solid a vertex\n{facet}{facet}endsolid a vertex\nsolid \xe9 facet\n{facet}endsolid\n"
    for data in (text.encode("latin-1"), text.upper().replace("\n", "\r\n").encode()):
        mesh = read(data, "stl")
        np.testing.assert_array_equal(mesh.faces, np.arange(9).reshape(3, 3))
        np.testing.assert_array_equal(mesh.vertices, [[0, 0, 0], [1, 0, 0], [0, 1, 0]] * 3)


def test_binary_stl_that_says_solid():
    data = b"solid facet" + mesh_bytes(V, F, "stl")[11:]
    assert len(read(data, "stl").faces) == 3


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "neither an ASCII STL nor a binary one"),
        (b"solid nothing\nendsolid nothing\n", "no vertices and no faces"),
        (bytes(84), "no vertices and no faces"),
        (mesh_bytes(V, F, "stl")[:-1], "header of 3 facets would mean 234 bytes: it has 233"),
        (mesh_bytes(V, F, "stl") + b"\0", "it has 235"),
        (b"solid\n" + FACET.format(CORNER_LINES).encode(), "only 0 of its 3 vertices.* cut short"),
        (
            b"solid\n" + FACET.format("vertex 0 0 0\nvertex 1 0 0\n").encode() + b"endsolid\n",
            "not readable as STL",
        ),
        (
            b"solid\n" + FACET.format("vertex a b c\n" * 3).encode() + b"endsolid\n",
            "not readable as STL|only 0 of its 3",
        ),
    ],
)
def test_malformed_stl(data, message):
    refused(data, "stl", message)


# GLB


def glb(tree, data=b""):
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(data)
    head = struct.pack("<4sIIII", b"glTF", 2, size, len(text), 0x4E4F534A)
    return head + text + struct.pack("<II", len(data), 0x004E4942) + data


def gltf_tree(**primitive):
    """Return one triangle as glTF, with two nodes that place it, and its buffer."""
    buffer = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4").tobytes()
    buffer += np.array([0, 1, 2, 0], dtype="<u2").tobytes()
    tree = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 1]}],
        "nodes": [
            {"mesh": 0, "translation": [0, 0, 5]},
            {"children": [2], "scale": [-2, 2, 2]},
            {"mesh": 0, "translation": [1, 0, 0]},
        ],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4} | primitive]}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": 6},
        ],
        "buffers": [{"byteLength": 44}],
    }
    return tree, buffer


def test_glb_scene_is_put_together():
    mesh = read(glb(*gltf_tree()), "glb")
    first = [[0, 0, 5], [1, 0, 5], [0, 1, 5]]
    mirrored = [[-2, 0, 0], [-4, 0, 0], [-2, 2, 0]]
    np.testing.assert_array_equal(mesh.vertices, first + mirrored)
    # A mirror turns the winding round, so that outside stays outside.
    np.testing.assert_array_equal(mesh.faces, [[0, 1, 2], [5, 4, 3]])


def test_glb_meshes_are_in_the_order_of_the_file():
    import trimesh

    scene = trimesh.Scene()
    for i in range(5):
        part = trimesh.Trimesh(V[[0, 1, 3]] * 0 + i, TRIANGLE, process=False)
        scene.add_geometry(part, node_name=f"node {i}", geom_name=f"part {i}")
    mesh = read(scene.export(file_type="glb"), "glb")
    np.testing.assert_array_equal(mesh.vertices[:, 0], np.repeat(np.arange(5), 3))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t: t.update(extensionsRequired=["KHR_draco_mesh_compression"]), "needs the glTF"),
        (lambda t: t.update(extensionsRequired=["EXT_meshopt_compression"]), "needs the glTF"),
        (lambda t: t["accessors"][0].update(sparse={"count": 1}), "sparse"),
        (lambda t: t["accessors"][0].update(normalized=True), "normalized"),
        (lambda t: t["accessors"][1].update(count=300), "not readable as GLB"),
        (lambda t: t["bufferViews"][0].update(byteLength=10**9), "not readable as GLB"),
        (lambda t: t["meshes"][0]["primitives"][0].update(mode=6), "triangle fan"),
        (lambda t: t["meshes"][0]["primitives"][0].update(mode=0), "no vertices and no faces"),
        (lambda t: t["meshes"][0]["primitives"][0].update(indices=9), "not readable as GLB"),
        (lambda t: t["scenes"][0].update(nodes=[]), "no vertices and no faces"),
        (lambda t: t.pop("meshes"), "not readable|no vertices and no faces"),
        (lambda t: t["buffers"][0].update(uri="/etc/hostname"), "not readable as GLB"),
    ],
)
def test_malformed_glb(change, message):
    tree, buffer = gltf_tree()
    change(tree)
    refused(glb(tree, buffer), "glb", message)


def test_other_files_are_not_glb():
    refused(b"", "glb", "does not begin with 'glTF'")
    refused(OFF.encode(), "glb", "does not begin with 'glTF'")
    refused(b"glTF" + bytes(40), "glb", "not readable as GLB")


# Any bytes


@pytest.mark.parametrize("file_format", FORMATS)
def test_every_truncation_is_read_or_refused(file_format):
    whole = mesh_bytes(np.array(POINTS), np.array([[0, 1, 2], [2, 1, 3]]), file_format)
    for size in range(0, len(whole), 1 if file_format != "glb" else 5):
        try:
            mesh = read(whole[:size], file_format)
        except MeshError:
            continue
        # Text can end within its last number, or before faces that OBJ announces nowhere.
        assert file_format in ("obj", "off")
        assert 1 <= len(mesh.faces) <= 2


@settings(deadline=None)
@given(st.sampled_from(FORMATS), st.binary(max_size=80), st.data())
def test_arbitrary_bytes_are_read_or_refused(file_format, noise, data):
    whole = mesh_bytes(np.array(POINTS), np.array([[0, 1, 2], [2, 1, 3]]), file_format)
    at = data.draw(st.integers(0, len(whole)))
    for raw in (noise, whole[:at] + noise + whole[at + len(noise) :]):
        try:
            mesh = read(raw, file_format)
        except MeshError:
            continue
        assert mesh.faces.max() < len(mesh.vertices)


# Real files

REAL = [
    ("clean/spot.obj", 2930, 5856),
    ("clean/pizza.obj", 24916, 49954),
    ("clean/tank.obj", 24950, 44590),
    ("clean/chair_model.obj", 3186, 12756),
    ("unstated/armadillo.obj", 43243, 86482),
    ("edge/negative_indices.obj", 8, 12),
    ("edge/dodecahedron_poly.obj", 20, 36),
    ("unstated/bun_zipper.ply", 35947, 69451),
    ("unstated/horse.ply", 48485, 96966),
    ("copyleft/face000_rangemap.ply", 85849, 166259),
    ("edge/fuze.ply", 502, 1000),
    ("edge/multi.ply", 4, 2),
    ("unstated/camelhead.off", 11381, 22704),
    ("copyleft/rgb_nefertiti.off", 10013, 20022),
    ("edge/inspired_quads_smooth.off", 1963, 3676),
    ("edge/comments.off", 8, 12),
    ("clean/1002_tray_bottom.STL", 13560, 4520),
    ("edge/multibody.stl", 96, 32),
]


def real(name):
    if not (MESHES / name).exists():
        pytest.skip(f"no {name} in {MESHES}: set DELTAMESH_MESHES")
    return MESHES / name


@pytest.mark.parametrize(("name", "vertices", "faces"), REAL)
def test_real_files(name, vertices, faces):
    mesh = read_mesh(real(name))
    assert (len(mesh.vertices), len(mesh.faces)) == (vertices, faces)
    assert np.isfinite(mesh.vertices).all()


def test_real_obj_positions_are_the_lines_of_the_file():
    path = real("clean/spot.obj")
    lines = [line.split()[1:4] for line in path.read_text().splitlines() if line[:2] == "v "]
    np.testing.assert_array_equal(read_mesh(path).vertices, np.array(lines, dtype=float))


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("edge/empty.ply", "no vertices and no faces"),
        ("edge/obj_empty.obj", "no vertices and no faces"),
        ("edge/stl_empty_bin.stl", "no vertices and no faces"),
        ("edge/ply_points_bin.ply", "a point cloud"),
        ("edge/points_emptyface.ply", "a point cloud"),
        ("edge/fairing_cross_binary.off", "binary OFF"),
    ],
)
def test_real_files_that_hold_no_mesh(name, message):
    with pytest.raises(MeshError, match=message) as caught:
        read_mesh(real(name))
    assert str(MESHES / name) in str(caught.value)
