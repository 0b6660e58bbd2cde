"""Comments of OBJ, lines that continue and names that do not, and colours of ZBrush."""

from __future__ import annotations

import numpy as np
import pytest
from cubes import OBJ, is_cube
from filetests import again, named, read, rows

from deltamesh_formats.meshfiles.obj.comments import comments_of, statements

BELOW = "comments below the first statement"
HEAD, FACES = OBJ[: OBJ.index("f ")], OBJ[OBJ.index("f ") :]


@pytest.mark.parametrize(
    ("text", "kept", "more"),
    [
        ("# a\n\n #b\r\nv 0 0 0\n", (" a", "b"), False),
        ("# a\nv 0 0 0\n# b\n", (" a",), True),
        ("v 0 0 0 # b\n", (), True),
        ("v 0 0 0\n\t#\n", (), True),
        ("g #1 # no comment\nusemtl red#2 #3\n", (), False),
        ("v 0 0 0\nmtllib a #b.mtl\nv 0 0 0 #c", (), True),
        ("#MRGB ff000000\n# a\nv 0 0 0\n#MRGB ff000000\n", (" a",), False),
        ("", (), False),
    ],
)
def test_comments(text: str, kept: tuple[str, ...], more: bool) -> None:
    assert comments_of(text.encode()) == (kept, more)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("f 1 2 \\\n3\n", "f 1 2   3\n"),
        ("f 1 2 \\ \t\r\n3\n", "f 1 2      3\n"),
        ("f 1 \\\n2 \\\n3\n", "f 1   2   3\n"),
        ("# C:\\\nf 1 2 3\n", "     \nf 1 2 3\n"),
        ("usemtl a\\b\\\nf 1 2 3 \\\n4\n", "usemtl a\\b\\\nf 1 2 3   4\n"),
        ("g a\\ \nf 1 2 3\n", "g a\\ \nf 1 2 3\n"),
        ("usemtl a\\b\nf 1 2 3\n", "usemtl a\\b\nf 1 2 3\n"),
    ],
)
def test_lines_continue_but_names_do_not(text: str, expected: str) -> None:
    assert statements(text.encode()).decode() == expected


@pytest.mark.parametrize("blanks", ["", " ", "\t  ", " \r"])
def test_a_face_continues_behind_blanks(blanks: str) -> None:
    assert is_cube(read(OBJ.replace("3 4 2", f"3 \\{blanks}\n 4 2"), "obj"))


@pytest.mark.parametrize(
    ("line", "kind", "name"),
    [
        ("usemtl lib\\stone\\", "material", "lib\\stone\\"),
        ("g C:\\parts\\", "group", "C:\\parts\\"),
        ("o x\\", "object", "x\\"),
        (" o x\\  ", "object", "x\\"),
    ],
)
def test_a_name_that_ends_in_a_backslash_swallows_nothing(line: str, kind: str, name: str) -> None:
    for text in (f"{HEAD}{line}\n{FACES}", f"{line}\n{OBJ}"):
        mesh = read(text, "obj")
        assert is_cube(mesh)
        assert named(mesh, kind) == [name] * 6
        assert mesh.lost == ()
        assert named(again(mesh, "obj"), kind) == [name] * 6


def test_a_library_that_ends_in_a_backslash() -> None:
    mesh = read("mtllib lib\\\n" + OBJ, "obj")
    assert is_cube(mesh)
    assert mesh.metadata == {"mtllib": ("lib\\",)}


@pytest.mark.parametrize(
    "text",
    [
        "# head\n" + HEAD + "# faces\n" + FACES,
        "# head\n" + OBJ + "# the end",
        "# head\n" + OBJ.replace("f 1 3 4 2", "f 1 3 4 2 # top"),
        "# head\n" + OBJ + "  # 8 vertices\n# 6 faces\n",
    ],
)
def test_comments_in_the_body_are_named(text: str) -> None:
    mesh = read(text, "obj")
    assert is_cube(mesh)
    assert mesh.metadata["comments"] == (" head",)
    assert mesh.lost == (BELOW,)


COLOURS = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]] * 2
DIGITS = "".join(f"ff{r:02x}{g:02x}{b:02X}" for r, g, b in COLOURS)


@pytest.mark.parametrize(
    "block",
    [
        f"#MRGB {DIGITS}\n",
        f"#MRGB {DIGITS[:40]}\n#MRGB {DIGITS[40:]}\r\n",
        f"\t#MRGB  {DIGITS[:8]}  \n# block\n#MRGB\t{DIGITS[8:]}\n",
    ],
)
def test_colours_of_zbrush_are_those_of_the_vertices(block: str) -> None:
    for text in (HEAD + block + FACES, "# made\n" + block + OBJ, OBJ + block):
        mesh = read(text, "obj")
        assert is_cube(mesh)
        assert rows(mesh, "colour", "vertex") == COLOURS
        (colour,) = mesh.attributes
        assert (colour.role, colour.normalized, colour.values.dtype) == ("colour", True, np.uint8)
        np.testing.assert_array_equal(
            rows(again(mesh, "obj"), "colour", "vertex"), np.array(COLOURS) / 255
        )
        assert not any("MRGB" in line for line in mesh.metadata.get("comments", ()))


def test_masks_and_colours_beside_those_of_zbrush_are_kept() -> None:
    digits = "00" + DIGITS[2:]
    mesh = read(OBJ.replace("v 0 0 0\n", "v 0 0 0 1 1 0\n") + f"#MRGB {digits}\n", "obj")
    assert rows(mesh, "mask", "vertex") == [[0], *[[255]] * 7]
    assert rows(mesh, "colour", "vertex")[:2] == [[1, 1, 0], None]
    assert rows(mesh, "colour1", "vertex") == COLOURS


@pytest.mark.parametrize(
    ("digits", "lost"),
    [
        (DIGITS[8:], "colours in comments (#MRGB) of 7 vertices, of 8"),
        (DIGITS + "ff", "colours in comments (#MRGB) of 8.25 vertices, of 8"),
        (DIGITS[1:], "colours in comments (#MRGB) that are not hexadecimal"),
        ("xx" + DIGITS[2:], "colours in comments (#MRGB) that are not hexadecimal"),
        ("\xe9" + DIGITS, "colours in comments (#MRGB) that are not hexadecimal"),
    ],
)
def test_colours_of_zbrush_that_do_not_fit_are_named(digits: str, lost: str) -> None:
    mesh = read(f"{OBJ}#MRGB {digits}\n", "obj")
    assert is_cube(mesh)
    assert (mesh.attributes, mesh.lost) == ((), (lost,))
