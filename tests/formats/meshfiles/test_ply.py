"""PLY: its three encodings, properties of any type and name, and what is no PLY."""

from __future__ import annotations

import struct
from dataclasses import replace

import numpy as np
import pytest
from filetests import POINTS, again, exact, polygons, read, refused, rows

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.files import mesh_bytes, written
from deltamesh_formats.meshfiles.ply.body import Ascii, Binary
from deltamesh_formats.meshfiles.ply.header import Element, Property, read_header
from deltamesh_formats.meshfiles.ply.properties import TYPES
from deltamesh_formats.meshfiles.ply.records import _counts_of, _row_width, _walk, read_rows
from deltamesh_formats.polymesh.mesh import Attribute, from_triangles

ENCODINGS = ["ascii", "binary_little_endian", "binary_big_endian"]
CODES = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I"}
CODES |= {"float": "f", "double": "d", "int64": "q"}


def ply(encoding, elements, remarks=()):
    """Build a PLY of elements: a name, properties such as "float x" or "list uchar int v", rows.

    Written record by record with struct, which knows nothing of the readers.
    """
    order = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}[encoding]
    header = ["ply", f"format {encoding} 1.0", *remarks]
    body = b""
    for name, properties, records in elements:
        header.append(f"element {name} {len(records)}")
        header += [f"property {p}" for p in properties]
        for record in records:
            numbers, codes = [], ""
            for prop, value in zip(properties, record, strict=True):
                words = prop.split()
                if words[0] == "list":
                    codes += CODES[words[1]] + len(value) * CODES[words[2]]
                    numbers += [len(value), *value]
                else:
                    codes += CODES[words[0]]
                    numbers.append(value)
            packed = struct.pack(order + codes, *numbers) if order else None
            body += packed or (" ".join(map(str, numbers)) + "\n").encode()
    return "\n".join([*header, "end_header", ""]).encode("latin-1") + body


XYZ = ["float x", "float y", "float z"]
FACES = ["list uchar int vertex_indices"]


def simple(encoding, faces, *, vertices=POINTS):
    return ply(encoding, [("vertex", XYZ, vertices), ("face", FACES, [[f] for f in faces])])


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    "faces",
    [[[2, 1, 0]], [[0, 1, 3, 2], [2, 3, 1, 0]], [[0, 1, 3, 2], [0, 1, 2], [3, 2, 1, 0]]],
    ids=["triangle", "quads", "mixed"],
)
def test_polygons(encoding, faces):
    mesh = read(simple(encoding, faces), "ply")
    np.testing.assert_array_equal(mesh.vertices, POINTS)
    assert polygons(mesh) == faces


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_properties_of_any_type_and_order(encoding):
    types = [t for t in CODES if t != "float"]
    properties = ["double z", *(f"{t} p_{t}" for t in types), "double y", "float nx", "double x"]
    values = [3, 200, -3, 60000, -5, 4_000_000_000, 0.1, -(2**60) + 1]
    records = [(z, *values, y, 0.5, x) for x, y, z in np.array(POINTS) / 3]
    weights = ["list uint float w", "uchar red", "list ushort short vertex_index", "uchar blue"]
    faces = [([0.5], 7, [0, 1, 2], 8), ([], 9, [2, 1, 3, 0], 10)]
    mesh = read(ply(encoding, [("face", weights, faces), ("vertex", properties, records)]), "ply")
    np.testing.assert_array_equal(mesh.vertices, np.array(POINTS) / 3)
    assert polygons(mesh) == [[0, 1, 2], [2, 1, 3, 0]]
    types = [struct.calcsize(CODES[t]) for t in types]
    kinds = [a.values.dtype.itemsize for a in mesh.attributes if a.name.startswith("p_")]
    assert kinds == types
    for name, value in zip([t for t in CODES if t != "float"], values, strict=True):
        assert rows(mesh, f"p_{name}", "vertex") == [[value]] * 4
    assert rows(mesh, "nx", "vertex") == [[0.5]] * 4
    assert rows(mesh, "red", "face") == [[7], [9]]
    assert mesh.lost == ("lists w of faces",)
    assert mesh.precision == "float64"


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_properties_that_are_one_attribute(encoding):
    colour = ["uchar red", "uchar green", "uchar blue", "uchar alpha"]
    vertex = [*XYZ, "float nx", "float ny", "float nz", *colour, "float s", "float t"]
    vertex += ["float f_0", "float f_1", "int q_0", "float u", "double v"]
    records = [(*p, 0, 0, 1, 1, 2, 3, 4, 0.25, 0.5, 7, 8, 9, 1, 2) for p in POINTS]
    face = [*FACES, *colour[:3], "list uchar float texcoord", "list uchar uchar colour"]
    faces = [
        ([0, 1, 2], 5, 6, 7, [0, 1, 2, 3, 4, 5], range(9)),
        ([2, 1, 3], 8, 9, 10, [], range(9)),
    ]
    mesh = read(ply(encoding, [("vertex", vertex, records), ("face", face, faces)]), "ply")
    assert rows(mesh, "normal", "vertex") == [[0, 0, 1]] * 4
    assert rows(mesh, "colour", "vertex") == [[1, 2, 3, 4]] * 4
    assert rows(mesh, "uv", "vertex") == [[0.25, 0.5]] * 4
    assert rows(mesh, "f", "vertex") == [[7, 8]] * 4
    assert rows(mesh, "q_0", "vertex") == [[9]] * 4
    assert rows(mesh, "v", "vertex") == [[2]] * 4, "u and v are of different types"
    assert rows(mesh, "colour", "face") == [[5, 6, 7], [8, 9, 10]]
    assert rows(mesh, "uv", "corner") == [[0, 1], [2, 3], [4, 5], None, None, None]
    assert rows(mesh, "colour", "corner") == 2 * [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    assert [a.role for a in mesh.attributes if a.name == "colour"] == ["colour"] * 3
    assert all(a.normalized == (a.role == "colour") for a in mesh.attributes)
    assert mesh.precision == ("float64" if encoding == "ascii" else "float32")


def test_the_names_of_other_programs_come_back():
    names = ["u", "v", "texture_u", "texture_v", "diffuse_red", "diffuse_green", "diffuse_blue"]
    vertex = [*XYZ, *(f"float {name}" for name in names)]
    data = ply(
        ENCODINGS[1],
        [("vertex", vertex, [(*p, *range(7)) for p in POINTS]), ("face", FACES, [[[0, 1, 2]]])],
    )
    header = mesh_bytes(read(data, "ply"), "ply").split(b"end_header")[0].decode()
    assert [line.split()[-1] for line in header.splitlines() if "float" in line][3:] == names


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_ends_of_lines(encoding, end):
    """A binary body that begins with a line feed is told from a header that ends in CR LF."""
    data = simple(encoding, [[0, 1, 2]], vertices=[[10, 0, 0], [1, 0, 0], [0, 1, 0]])
    head, mark, body = data.partition(b"end_header\n")
    body = body.replace(b"\n", end.encode()) if encoding == "ascii" else b"\n" + body[1:]
    mesh = read((head + mark).replace(b"\n", end.encode()) + body, "ply")
    assert len(mesh.vertices) == 3
    assert polygons(mesh) == [[0, 1, 2]]


def test_text_may_have_more_digits_than_its_type():
    data = ply(
        "ascii",
        [
            ("vertex", XYZ, [(4512345.678, 0, 0), (1, 0, 0), (0, 0.1, 0)]),
            ("face", FACES, [[[0, 1, 2]]]),
        ],
    )
    mesh = read(data, "ply")
    assert mesh.vertices[0, 0] == 4512345.678
    np.testing.assert_array_equal(again(mesh, "ply").vertices, mesh.vertices)


def test_comments_and_other_elements():
    elements = [
        ("camera", ["float view", "list uchar int u"], [(1.5, [1, 2])]),
        ("vertex", [*XYZ, "list uchar int ring"], [(*p, [1] * i) for i, p in enumerate(POINTS)]),
        ("face", FACES, [[[0, 1, 2]]]),
        ("edge", ["int vertex1", "int vertex2"], [(0, 1), (1, 2)]),
        ("nothing", [], []),
    ]
    remarks = ["comment  by \xe4", "obj_info x y", "Created by nobody", "comment"]
    for encoding in ENCODINGS:
        mesh = read(ply(encoding, elements, remarks), "ply")
        assert polygons(mesh) == [[0, 1, 2]]
        np.testing.assert_array_equal(mesh.vertices, POINTS)
        assert mesh.lost == ("elements camera", "elements edge", "lists ring of vertices")
        assert mesh.metadata["comments"] == (" by \udce4", "Created by nobody", "")
        assert mesh.metadata["obj_info"] == ("x y",)
        assert again(replace(mesh, lost=()), "ply").metadata == mesh.metadata


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_triangle_strips(encoding):
    strips = [[[0, 1, 2, 3, -1, 3, 2, 1, -1]], [[0, 1, 1, 2, 3]]]
    data = ply(encoding, [("vertex", XYZ, POINTS), ("tristrips", FACES, strips)])
    faces = [[0, 1, 2], [2, 1, 3], [3, 2, 1], [1, 2, 3]]
    assert polygons(read(data, "ply")) == faces


def test_large_polygons_and_lists():
    n = 300
    mesh = from_triangles(np.random.default_rng(0).normal(size=(n, 3)), np.array([[0, 1, 2]]))
    mesh = replace(mesh, corners=np.arange(n), offsets=np.array([0, n]))
    uv = Attribute("uv", "corner", np.arange(2.0 * n).reshape(n, 2), "uv")
    back = again(replace(mesh, attributes=(uv,)), "ply")
    assert polygons(back) == [list(range(n))]
    assert rows(back, "uv", "corner") == uv.values.tolist()


def test_types_that_ply_has_not():
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    values = {
        "bool": np.array([[True], [False], [True]]),
        "half": np.array([[0.5], [1], [2]], dtype=np.float16),
        "small": np.array([[-1], [2], [3]], dtype=np.int64),
        "large": np.array([[2**40], [2], [3]], dtype=np.uint64),
        "huge": np.array([[2**60 + 1], [2], [3]], dtype=np.int64),
        "complex": np.array([[1j], [2], [3]]),
    }
    attributes = tuple(Attribute(name, "vertex", v) for name, v in values.items())
    made = written(replace(mesh, attributes=attributes), "ply")
    assert made.lost == ("huge of vertices", "complex of vertices")
    back = read(made.data, "ply")
    kinds = {a.name: a.values.dtype.str[1:] for a in back.attributes}
    assert kinds == {"bool": "u1", "half": "f4", "small": "i4", "large": "f8"}
    for attribute in back.attributes:
        np.testing.assert_array_equal(attribute.values, values[attribute.name])


def test_names_that_ply_cannot_tell_apart():
    mesh = from_triangles(np.eye(3), np.array([[0, 1, 2]]))
    attributes = [Attribute(n, "vertex", np.zeros((3, 1))) for n in ("x", "my name", "my_name", "")]
    back = again(replace(mesh, attributes=tuple(attributes)), "ply")
    assert [a.name for a in back.attributes] == ["x_2", "my_name", "my_name_2", "property"]
    np.testing.assert_array_equal(back.vertices, mesh.vertices)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("faces", [[[0, 1, 2]] * 4, [[0, 1, 3, 2], [0, 1, 2]]], ids=["one", "two"])
def test_half_a_file_is_refused(encoding, faces):
    data = simple(encoding, faces)
    # An ASCII file can lose the end of its last number and still be one.
    start, end = data.index(b"end_header") + 11, len(data) - (2 if encoding == "ascii" else 0)
    for size in range(start, end):
        refused(data[:size], "ply", "cut short")


TEXT = simple("ascii", [[0, 1, 2], [2, 1, 3]])
BINARY = simple("binary_little_endian", [[0, 1, 2]])


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "does not begin with 'ply'"),
        (b"solid", "does not begin with 'ply'"),
        (b"plyx\n", "does not begin with 'ply'"),
        (b"ply\nformat ascii 1.0\nelement ver", "header has no end"),
        (simple("ascii", [], vertices=[]), "no vertices and no faces"),
        (simple("ascii", []), "4 vertices but no faces: a point cloud"),
        (simple(ENCODINGS[1], []), "a point cloud"),
        (simple("ascii", [[0, 1, 4]]), exact("face 0 has vertex indices [0, 1, 4], outside 0..3")),
        (simple("ascii", [[0, 1, 2], [0, -1, 2]]), "face 1 has vertex indices"),
        (TEXT.replace(b"3 2 1 3", b"3 a 1 2"), "line 15: 'a' is not a number"),
        (TEXT.replace(b"3 2 1 3", b"3 1.5 1 2"), "line 15: '1.5' is not a whole number of 32 bits"),
        (TEXT.replace(b"3 2 1 3", b"2.5 1 1 2"), "line 15: 2.5 is not a count"),
        (TEXT.replace(b"3 2 1 3", b"-3 1 1 2"), "line 15: a list of -3 numbers"),
        (TEXT.replace(b"3 2 1 3", b"3 2 1 3000000000"), "line 15: '3000000000' is not a whole"),
        (TEXT + b"1 2\n", "line 16: 2 numbers follow the last element"),
        (
            TEXT.replace(b"float x", b"quad x"),
            "line 4: not a line of a PLY header: 'property quad x'",
        ),
        (TEXT.replace(b"float x", b"float q"), "no properties x, y and z"),
        (
            TEXT.replace(b"float x", b"list uchar float x"),
            "line 11: vertex 1 has 3 numbers, not 4 as the header says",
        ),
        (TEXT.replace(b"list uchar", b"list float"), "line 8: not a line of a PLY header"),
        (TEXT.replace(b"int vertex_indices", b"float vertex_indices"), "no list vertex_indices"),
        (TEXT.replace(b"vertex_indices", b"corners"), "no list vertex_indices"),
        (
            TEXT.replace(b"property float z", b"propery float z"),
            "line 6: not a line of a PLY header",
        ),
        (TEXT.replace(b"vertex 4", b"vertex four"), "line 3: not a line of a PLY header"),
        (TEXT.replace(b"vertex 4", b"vertex -4"), "line 3: not a line of a PLY header"),
        (TEXT.replace(b"format ascii 1.0\n", b""), "header has no format"),
        (TEXT.replace(b"ascii", b"binary_middle_endian"), "line 2: not a line of a PLY header"),
        (TEXT.replace(b"element vertex 4\n", b""), "line 3: not a line of a PLY header"),
        (BINARY.replace(b"element vertex 4", b"element vertex 6"), "cut short"),
    ],
)
def test_malformed(data, message):
    refused(data, "ply", message)


def test_bytes_after_the_last_element_are_named():
    assert read(BINARY + b"\n\n", "ply").lost == ("2 bytes after the last element",)


# ---- Records of different lengths --------------------------------------------------------------


def walked(body, at, n, properties):
    """What `records._walk` returns, record by record."""
    starts, lengths = [], []
    for _ in range(n):
        counts = _counts_of(body, at, properties)
        starts.append(at)
        lengths.append(counts)
        at += _row_width(body, properties, counts)
    return np.array(starts, dtype=np.int64), np.array(lengths, dtype=np.int64), at


def outcome(walk, *arguments):
    try:
        starts, lengths, end = walk(*arguments)
    except (IndexError, MeshError) as error:
        return type(error), str(error)
    return starts.tolist(), lengths.reshape(len(starts), -1).tolist(), end


def body_of(encoding, properties, rows_of):
    data = ply(encoding, [("face", properties, rows_of)])
    header = read_header(data)
    body = data[header.body :]
    found = Binary(body, header.order) if header.order else Ascii(text.split_lines(body))
    return found, header.elements[0].properties


LISTS = {
    "faces": FACES,
    "two lists": ["list uchar int a", "float x", "list ushort double b"],
    "wide counts": ["list int uchar a", "list uint short b", "char c"],
}


@pytest.mark.parametrize("window", [1, 7, 1 << 16])
@pytest.mark.parametrize("name", LISTS)
@pytest.mark.parametrize("encoding", ENCODINGS)
def test_walk_is_that_of_one_record_after_the_other(encoding, name, window, monkeypatch):
    monkeypatch.setattr("deltamesh_formats.meshfiles.ply.records._WINDOW", window)
    random = np.random.default_rng(5)
    rows_of = [
        [[1] * int(random.integers(0, 6)) if prop.startswith("list") else 2 for prop in LISTS[name]]
        for _ in range(60)
    ]
    body, properties = body_of(encoding, LISTS[name], rows_of)
    size = len(body.cells)
    for n in (1, 59, 60, 61, 200):
        expected = outcome(walked, body, 0, n, properties)
        assert outcome(_walk, body, 0, n, properties) == expected
        assert (expected[0] is IndexError) == (n > 60)
    for cut in range(1, 12):  # in the middle of a record, and of a count
        shorter = replace(body, data=body.data[:-cut]) if encoding != "ascii" else body
        expected = outcome(walked, shorter, 0, 60, properties)
        assert outcome(_walk, shorter, 0, 60, properties) == expected
    for at in range(0, size, 3):  # whatever bytes are taken for counts
        expected = outcome(walked, body, at, 20, properties)
        assert outcome(_walk, body, at, 20, properties) == expected


@pytest.mark.parametrize(
    ("encoding", "count", "data"),
    [
        ("binary_little_endian", "char", b"\1\0\0\0\0\xff"),
        ("binary_big_endian", "int", b"\0\0\0\0\xff\xff\xff\xfe"),
        ("binary_little_endian", "int64", b"\0" * 8 + b"\xff" * 7 + b"\x7f"),
        ("binary_little_endian", "uint64", b"\0" * 8 + b"\xff" * 8),
        ("ascii", "uchar", b"1 2 0 -1"),
        ("ascii", "uchar", b"1 2 0.5"),
        ("ascii", "uchar", b"1 2 nan 3"),
        ("ascii", "uchar", b"1 2 1e300 3"),
    ],
)
def test_what_is_no_count_is_refused_alike(encoding, count, data):
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}.get(encoding)
    body = Binary(data, order) if order else Ascii(text.split_lines(data))
    properties = [Property("v", "i4", TYPES[count])]
    expected = outcome(walked, body, 0, 9, properties)
    assert isinstance(expected[0], type)
    assert outcome(_walk, body, 0, 9, properties) == expected


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_polygons_of_many_sizes(encoding):
    sizes = np.random.default_rng(1).integers(3, 250, 400)
    faces = [[int(i) for i in np.arange(size) % 4] for size in sizes]
    mesh = read(simple(encoding, faces), "ply")
    assert polygons(mesh) == faces


def test_a_million_mixed_faces():
    """Triangles, quads and empty lists, over many windows."""
    count = 1_000_000
    pieces = [b"\3" + struct.pack("<3i", 0, 1, 2), b"\4" + struct.pack("<4i", 0, 1, 3, 2), b"\0"]
    body = b"".join(pieces[i % 3] for i in range(count))
    properties = [Property("vertex_indices", "i4", "u1")]
    columns, end = read_rows(Binary(body, "<"), 0, Element("face", count, properties))
    assert end == len(body)
    np.testing.assert_array_equal(columns["vertex_indices"].counts[:6], [3, 4, 0, 3, 4, 0])
    np.testing.assert_array_equal(columns["vertex_indices"].values[:8], [0, 1, 2, 0, 1, 3, 2, 0])
