"""Files that other readers read: the same mesh as from a clean file, and words for what is lost."""

from __future__ import annotations

import re
import time

import numpy as np
import pytest
from cubes import OBJ, OFF, PLY, PLY_BODY, PLY_HEADER, STL, VERTICES, is_cube
from filetests import exact, named, polygons, read, refused, rows

import deltamesh

TEXTS = {"obj": OBJ, "off": OFF, "ply": PLY, "stl": STL}
BINARY_HEADER = PLY_HEADER.replace("ascii", "binary_little_endian")


@pytest.mark.parametrize("file_format", TEXTS)
@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"])
@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
def test_marks_and_wide_text(file_format: str, encoding: str, ends: str) -> None:
    mesh = read(TEXTS[file_format].replace("\n", ends).encode(encoding), file_format)
    assert is_cube(mesh)
    assert mesh.lost == ()


def test_a_mark_before_a_binary_ply_and_off() -> None:
    data = b"\xef\xbb\xbf" + BINARY_HEADER.encode() + PLY_BODY
    assert is_cube(read(data, "ply"))
    counts = np.array([8, 6, 0], dtype=">i4").tobytes()
    faces = b"".join(
        np.array([4, *face, 0], dtype=">i4").tobytes() for face in polygons(read(OFF, "off"))
    )
    body = counts + VERTICES.astype(">f4").tobytes() + faces
    assert is_cube(read(b"\xef\xbb\xbfOFF BINARY\n" + body, "off"))
    refused(BINARY_HEADER.encode("utf-16") + PLY_BODY, "ply", "UTF-16")


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + OBJ,  # the first statement is a vertex
        "\ufeff# made\n" + OBJ,
        "\ufeffmtllib a.mtl\n" + OBJ,
        OBJ[: OBJ.index("f ")] + "\ufeff" + OBJ[OBJ.index("f ") :],  # two files put together
    ],
)
def test_no_mark_shifts_the_indices_of_an_obj(text: str) -> None:
    mesh = read(text.replace("f 1 ", "v 9 9 9\nf 1 ", 1), "obj")
    assert is_cube(mesh, more=1)
    assert mesh.lost == ()


@pytest.mark.parametrize("file_format", TEXTS)
@pytest.mark.parametrize("part", range(4))
def test_every_carriage_return_ends_a_line(file_format: str, part: int) -> None:
    """The head, the end, every second line, or two lines of three end in CR alone."""
    text = TEXTS[file_format]
    half, lines = len(text) // 2, text.splitlines()
    mixed = [
        text[:half].replace("\n", "\r") + text[half:],
        text[:half] + text[half:].replace("\n", "\r"),
        "".join(line + "\n\r"[i % 2] for i, line in enumerate(lines)),
        "".join(line + ("\r", "\r", "\r\n")[i % 3] for i, line in enumerate(lines)),
    ][part]
    mesh = read(mixed, file_format)
    assert is_cube(mesh)
    assert mesh.lost == ()


@pytest.mark.parametrize(
    ("text", "groups"),
    [
        (OBJ.replace("f 1 3 4 2\n", "g top\rf 1 3 4 2\n"), ["top"] * 6),
        (OBJ.replace("f 3", "g side\rf 3"), [None] * 3 + ["side"] * 3),
        ("# tool\r" + OBJ.replace("f 1 5", "# next\rg a b\r\rf 1 5"), [None] * 4 + ["a b"] * 2),
        ("g x\r\r\n" + OBJ.replace("\n", "\r\r\n"), ["x"] * 6),
    ],
)
def test_no_name_or_comment_swallows_a_line(text: str, groups: list[str | None]) -> None:
    mesh = read(text, "obj")
    assert is_cube(mesh)
    assert named(mesh, "group") == groups


def with_indices(template: str, more: str = "") -> str:
    """The cube with the fields of its corners, of which "#" is the vertex, and other lines."""
    lines = [
        " ".join(["f", *(template.replace("#", i) for i in line.split()[1:])])
        if line.startswith("f")
        else line
        for line in OBJ.splitlines()
    ]
    return more + "\n".join([*lines, ""])


NO_UV = "indices of texture coordinates that the file does not have"
NO_NORMALS = "indices of normals that the file does not have"


@pytest.mark.parametrize(
    ("text", "lost"),
    [
        (with_indices("#/#/1"), (NO_UV, NO_NORMALS)),
        (with_indices("#//7"), (NO_NORMALS,)),
        (with_indices("#/9"), (NO_UV,)),
        (with_indices("#/-1/-6"), (NO_UV, NO_NORMALS)),
        (with_indices("#/0/0"), (NO_UV, NO_NORMALS)),
        (with_indices("#/0", "vt 0 0\n"), (NO_UV, "texture coordinates that no face refers to")),
        (with_indices("#//0", "vn 0 0 1\n"), (NO_NORMALS, "normals that no face refers to")),
        (with_indices("#/"), ()),
        (with_indices("#//"), ()),
    ],
)
def test_faces_are_sound_without_texture_coordinates_and_normals(
    text: str, lost: tuple[str, ...]
) -> None:
    mesh = read(text, "obj")
    assert is_cube(mesh)
    assert (mesh.attributes, mesh.lost) == ((), lost)


def test_zero_is_no_index_beside_others() -> None:
    text = OBJ.replace("f 1 3 4 2", "f 1/1/1 3/0/1 4/2/0 2/1/1") + "vt 0 0\nvt 1 1\nvn 0 0 1\n"
    mesh = read(text, "obj")
    assert is_cube(mesh)
    assert rows(mesh, "uv", "corner")[:5] == [[0, 0], None, [1, 1], [0, 0], None]
    assert rows(mesh, "normal", "corner")[:5] == [[0, 0, 1], [0, 0, 1], None, [0, 0, 1], None]
    assert mesh.lost == (NO_UV, NO_NORMALS)
    refused(text.replace("4/2/0", "4/3/0"), "obj", "line 9: a face refers to texture coordinate 3")


@pytest.mark.parametrize(
    ("number", "value"),
    [
        ("-1.#IND", np.nan),
        ("1.#IND00", np.nan),
        ("-1.#IND000000000", np.nan),
        ("1.#QNAN0", np.nan),
        ("1.#SNAN", np.nan),
        ("-1.#IO", np.nan),
        ("1.#J", np.nan),
        ("1.#INF", np.inf),
        ("-1.#INF00", -np.inf),
        ("-nan(ind)", np.nan),
        ("+inf", np.inf),
        ("2.5D-01", 0.25),
        ("-1d2", -100),
    ],
)
def test_numbers_of_other_libraries(number: str, value: float) -> None:
    faces = OBJ.replace("f 1 3 4 2", "f 1/1 3/1 4/2 2/2")
    mesh = read(faces + f"vt {number} 0.5\nvt 0 1\nvn 0 {number} 0 # 1.#INF\n", "obj")
    assert is_cube(mesh)
    np.testing.assert_array_equal(rows(mesh, "uv", "corner")[0], [value, 0.5])
    ply = PLY.replace("float z\n", "float z\nproperty float q\n")
    ply = re.sub(r"(?m)^(\d \d \d)$", rf"\1 {number}", ply)
    mesh = read(ply, "ply")
    assert is_cube(mesh)
    np.testing.assert_array_equal(rows(mesh, "q", "vertex"), [[value]] * 8)
    off = re.sub(r"(?m)^(\d \d \d)$", rf"\1 0 {number} 0 # q", "N" + OFF)
    mesh = read(off.replace("NOFF\n8 6 0 0 " + number + " 0", "NOFF\n8 6 0"), "off")
    assert is_cube(mesh)
    np.testing.assert_array_equal(rows(mesh, "normal", "vertex"), [[0, value, 0]] * 8)


@pytest.mark.parametrize("number", ["1.#FOO", "1.#IND7", "2.#INF", "x1.#IND", "1,5", "1.5f", "1d"])
def test_other_spellings_are_no_numbers(number: str) -> None:
    refused(OBJ + f"vt 0.5 0.5\nvt {number} 0\n", "obj", f"line 16: '{number}' is not a number")
    refused(OBJ.replace("v 1 1 0", f"v 1 {number} 0"), "obj", f"line 4: '{number}' is not")


@pytest.mark.parametrize("number", ["1.#IND", "-1.#INF", "nan"])
def test_positions_have_to_be_finite(number: str) -> None:
    refused(OBJ.replace("v 1 1 0", f"v 1 {number} 0"), "obj", "vertex 3 is not finite")


# PLY


@pytest.mark.parametrize(
    ("end", "ends"),
    [
        ("\r\n", "\n"),
        ("\n", "\r\n"),
        ("\r", "\r"),
        ("\r", "\n"),
        ("\n", "\r"),
        (" \t\r\n", "\n"),
        ("\r\n", "\r\n"),
    ],
)
@pytest.mark.parametrize("first", [b"", b"\n", b"\r", b"\r\n"], ids=["", "LF", "CR", "CRLF"])
def test_the_header_of_a_binary_ply_ends_in_its_own_way(end: str, ends: str, first: bytes) -> None:
    """The first bytes of the body may be those of a line end."""
    if end == "\r" and first[:1] == b"\n" and ends == "\n":
        return  # LF lines and CR LF behind end_header: that is a line end, not a body
    header = BINARY_HEADER.replace(
        "element vertex", "element camera 1\nproperty int a\nelement vertex"
    )
    lines = header.replace("\n", ends).removesuffix(ends) + end
    mesh = read(lines.encode() + first.ljust(4, b"\1") + PLY_BODY, "ply")
    assert is_cube(mesh)
    assert mesh.lost == ("elements camera",)


@pytest.mark.parametrize("mixed", ["\r", "\n\r"])
def test_a_header_whose_end_is_not_clear_is_refused(mixed: str) -> None:
    header = BINARY_HEADER.replace("\nelement face", mixed + "element face")
    data = header.removesuffix("\n").encode() + b"\r\n" + PLY_BODY
    refused(data, "ply", "not clear whether the line feed below 'end_header'")
    ascii_ = data[: -len(PLY_BODY)].replace(b"binary_little_endian", b"ascii")
    assert is_cube(read(ascii_ + PLY[len(PLY_HEADER) :].encode(), "ply"))


@pytest.mark.parametrize(
    ("before", "again", "message"),
    [
        ("element face", "property float x\n", "line 7: vertex has the property 'x' twice"),
        ("element face", "property uchar y\n", "line 7: vertex has the property 'y' twice"),
        ("element face", "property list uchar int z\n", "line 7: vertex has the property 'z'"),
        (
            "end_header",
            "property list uchar int vertex_indices\n",
            "line 9: face has the property 'vertex_indices' twice",
        ),
    ],
)
def test_properties_that_are_there_twice_are_refused(before: str, again: str, message: str) -> None:
    refused(PLY.replace(before, again + before), "ply", message)


STRIPS = "element tristrips 2\nproperty list int int vertex_indices\n"
STRIP_ROWS = "5 0 1 2 3 -1\n8 4 6 5 7 -1 0 1 4\n"
STRIP_FACES = [[0, 1, 2], [2, 1, 3], [4, 6, 5], [5, 6, 7], [0, 1, 4]]


def stripped(faces: int, colour: str = "") -> tuple[str, str]:
    """A PLY with so many faces, and strips below or above them."""
    head = PLY_HEADER.replace("face 6", f"face {faces}").replace("end_header\n", "")
    head, colours = head + colour, " 9 8 7" if colour else ""
    points = "".join(f"{row}\n" for row in PLY[len(PLY_HEADER) :].splitlines()[:8])
    rows_ = "".join(f"3 0 2 {i + 3}{colours}\n" for i in range(faces))
    below = head + STRIPS + "end_header\n" + points + rows_ + STRIP_ROWS
    start = head.index("element face")
    above = head[:start] + STRIPS + head[start:] + "end_header\n" + points + STRIP_ROWS + rows_
    return below, above


@pytest.mark.parametrize("count", [0, 1, 3])
def test_strips_are_read_beside_faces(count: int) -> None:
    below, above = (read(text, "ply") for text in stripped(count))
    faces = [[0, 2, i + 3] for i in range(count)]
    assert polygons(below) == faces + STRIP_FACES
    assert polygons(above) == STRIP_FACES + faces
    assert (below.lost, above.lost) == ((), ())


def test_colours_of_faces_beside_strips() -> None:
    colour = "".join(f"property uchar {name}\n" for name in ("red", "green", "blue"))
    below, above = (read(text, "ply") for text in stripped(2, colour))
    assert rows(below, "colour", "face") == [[9, 8, 7]] * 2 + [None] * 5
    assert rows(above, "colour", "face") == [None] * 5 + [[9, 8, 7]] * 2
    none, _ = (read(text, "ply") for text in stripped(0, colour))
    assert none.attributes == ()


def test_lists_of_corners_beside_strips_and_properties_of_strips() -> None:
    text, _ = stripped(1)
    text = text.replace("element tri", "property list uchar float texcoord\nelement tri")
    text = text.replace("3 0 2 3\n", "3 0 2 3 6 1 2 3 4 5 6\n")
    text = text.replace("end_header", "property int id\nend_header")
    text = text.replace("3 -1\n", "3 -1 77\n").replace("0 1 4\n", "0 1 4 77\n")
    mesh = read(text, "ply")
    assert polygons(mesh) == [[0, 2, 3], *STRIP_FACES]
    assert rows(mesh, "uv", "corner") == [[1, 2], [3, 4], [5, 6], *[None] * 15]
    assert mesh.lost == ("properties id of triangle strips",)


# OFF


@pytest.mark.parametrize(
    "text",
    [
        OFF.replace("OFF\n", "OFF"),
        OFF.replace("OFF\n", "\n# ModelNet\nOFF"),
        OFF.replace("OFF\n8 6 0", "OFF8 6"),
        OFF.replace("OFF\n", "OFF").replace("\n", "\r\n"),
        OFF.replace("OFF\n8 6 0\n", "OFF8 6 0 "),
    ],
)
def test_counts_may_be_glued_to_the_keyword(text: str) -> None:
    mesh = read(text, "off")
    assert is_cube(mesh)
    assert mesh.lost == ()


@pytest.mark.parametrize("text", ["OFFS\n8 6 0\n", "OFF-8 6 0\n", "4OFF8 6 0\n", "OFFx8 6 0\n"])
def test_other_keywords_stay_refused(text: str) -> None:
    refused(OFF.replace("OFF\n8 6 0\n", text), "off", "does not begin with 'OFF'|three coordinates")


@pytest.mark.parametrize(
    ("text", "comments", "lost"),
    [
        ("# a\nOFF\n#b\n" + OFF[4:], (" a", "b"), False),
        (OFF.replace("OFF", "OFF # a cube"), (), True),
        (OFF + "# the end\n", (), True),
        (OFF.replace("1 1 1\n", "1 1 1\n# faces\n"), (), True),
        (OFF.replace("1\n", "1 # v\n"), (), True),
    ],
)
def test_comments_of_off_come_back_or_are_named(
    text: str, comments: tuple[str, ...], lost: bool
) -> None:
    mesh = read(text, "off")
    assert is_cube(mesh)
    assert mesh.metadata.get("comments", ()) == comments
    assert mesh.lost == ("comments among the numbers",) * lost


# Points and lines

CLOUD = "a point cloud, which LAZ, Draco and pcodec compress"
LINES = "a set of lines (and {}), which pcodec compresses"
POINTS_OF_OBJ = OBJ[: OBJ.index("f ")]
EDGES = (
    PLY_HEADER.replace("face 6", "edge 1").replace("list uchar int vertex_indices", "int vertex1")
    + "0 0 0\n" * 8
    + "5\n"
)


@pytest.mark.parametrize(
    ("data", "file_format", "message"),
    [
        (POINTS_OF_OBJ, "obj", CLOUD),
        (POINTS_OF_OBJ.replace("v 1 0 0", "v nan nan nan"), "obj", CLOUD),
        (PLY_HEADER.replace("face 6", "face 0") + "0 0 0\n" * 8, "ply", CLOUD),
        (PLY_HEADER.replace("face 6", "face 0") + "nan nan nan\n" * 8, "ply", CLOUD),
        ("OFF\n2 0 0\n0 0 0\n1 1 1\n", "off", CLOUD),
        (POINTS_OF_OBJ + "p 1 2 3\n", "obj", "a point cloud (and points), which LAZ"),
        (POINTS_OF_OBJ + "l 1 2 3\n", "obj", LINES.format("lines")),
        (
            "OFF\n2 1 0\n0 0 0\n1 1 1\n2 0 1\n",
            "off",
            LINES.format("1 faces of fewer than three corners"),
        ),
        (EDGES, "ply", LINES.format("elements edge")),
    ],
)
def test_points_and_lines_are_refused_with_what_compresses_them(
    data: str, file_format: str, message: str
) -> None:
    with pytest.raises(deltamesh.NoSurfaceError, match=exact(message)):
        read(data, file_format)


def test_curves_and_nothing_are_neither_points_nor_lines() -> None:
    for text in (POINTS_OF_OBJ + "cstype bezier\ncurv 0 1 1 2 3\nend\n", "# nothing\n"):
        with pytest.raises(deltamesh.MeshError, match="no faces") as caught:
            read(text, "obj")
        assert type(caught.value) is deltamesh.MeshError


def test_a_message_prints_no_long_face() -> None:
    face = " ".join(map(str, [*range(92), 99]))
    text = "OFF\n93 1 0\n" + "0 0 0\n" * 93 + f"93 {face}\n"
    refused(text, "off", "face 0, of 93 corners, has the vertex index 99, outside 0..92$")


MANY = 1 << 18


@pytest.mark.parametrize(
    ("data", "file_format"),
    [
        ("#" * MANY + " OF", "off"),
        ("# " * MANY, "off"),
        ("OFF" + "#" * MANY, "off"),
        ("\r" * MANY + "\n", "obj"),
        ("\r" * MANY + "v", "obj"),
        ("#MRGB" + " " * MANY + "x y\n", "obj"),
        ("#" * MANY + "\n\\" + " " * MANY + "x", "obj"),
        ("\\\n" * MANY, "obj"),
        ("\\ \ng " * (MANY // 4), "obj"),
        ("solid\n" + "end " * MANY, "stl"),
        ("solid\nend" + " " * MANY + "x\n", "stl"),
        ("solid\n" + "facet\n" * MANY, "stl"),
        ("solid\nfacet" + " \n" * MANY + "x", "stl"),
        ("solid\nendfacet\n" + "x\n" * MANY + "1", "stl"),
        ("ply\n" + "\r" * MANY + "end_header", "ply"),
        ("ply\n" + "end_header " * MANY, "ply"),
        ("1." + "#" * MANY + "\nv 0 0 1.#IND" * 9, "obj"),
    ],
)
def test_no_text_takes_long(data: str, file_format: str) -> None:
    """Expressions that are tried at each byte, and read on from there, would take minutes."""
    start = time.process_time()
    refused(data, file_format)
    assert time.process_time() - start < 10
