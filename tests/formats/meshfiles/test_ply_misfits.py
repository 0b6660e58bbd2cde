"""Rows of a text PLY that do not fit its header are named with their line."""

from __future__ import annotations

import pytest
from cubes import PLY, PLY_HEADER, is_cube
from filetests import read, refused

from deltamesh_formats.meshfiles import text
from deltamesh_formats.meshfiles.ply.body import Ascii
from deltamesh_formats.meshfiles.ply.header import Element, Property
from deltamesh_formats.meshfiles.ply.misfits import misfit

POINT = Element("vertex", 2, [Property(name, "f4") for name in "xyz"])
FACE = Element("face", 1, [Property("vertex_indices", "i4", "u1"), Property("q", "u1")])


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("1 2 3\n4 5 6\n3 0 1 2 7\n", None),
        ("1 2 3\n\n4 5 6 7\n3 0 1 2 7\n", "line 3: vertex 1 has 4 numbers, not 3"),
        ("1 2\n4 5 6\n3 0 1 2 7\n", "line 1: vertex 0 has 2 numbers, not 3"),
        ("1 2 3\n4 5 6\n3 0 1 2\n7\n", "line 3: face 0 has 4 numbers, not 5"),
        ("1 2 3\n4 5 6\n3 0 1 2 7 8\n", "line 3: face 0 has 6 numbers, not 5"),
        ("1 2 3\n4 5 6\n3 0 1 2\n", None),  # cut short
        ("1 2 3\n4 5\n", None),
        ("1 2 3\n", None),
        ("1 2 3\n4 5 6\n2.5 0 1 2 7\n", None),  # no count
        ("1 2 3\n4 5 6\n-1 0 1 2 7\n", None),
    ],
)
def test_the_first_misfit_is_named(rows: str, message: str | None) -> None:
    error = misfit(Ascii(text.split_lines(rows.encode())), [POINT, FACE])
    assert (error is None) == (message is None)
    assert message is None or str(error) == f"{message} as the header says"


def _columns(*more: str) -> str:
    """The cube with more numbers behind those of its vertices."""
    head, body = PLY[: len(PLY_HEADER)], PLY[len(PLY_HEADER) :].splitlines()
    return head + "\n".join([*(" ".join([row, *more]) for row in body[:8]), *body[8:], ""])


QUALITY = PLY_HEADER.replace("property list", "property uchar q\nproperty list")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (_columns("7"), "line 10: vertex 0 has 4 numbers, not 3 as the header says"),
        (_columns("0.5", "0.25"), "line 10: vertex 0 has 5 numbers, not 3 as the header says"),
        (_columns("7").replace("\n", "\r"), "line 10: vertex 0 has 4 numbers"),
        (PLY.replace("4 4 5 7 6", "4 4 5 7 6 255 0 0"), "line 19: face 1 has 8 numbers, not 5"),
        (PLY.replace("4 4 5 7 6", "4 4 5 7"), "line 19: face 1 has 4 numbers, not 5"),
        (PLY.replace("1 1 0\n", "1 1\n"), "line 13: vertex 3 has 2 numbers, not 3"),
        (PLY.replace(PLY_HEADER, QUALITY), "line 19: face 0 has 5 numbers"),
    ],
)
def test_a_cube_with_other_columns_is_refused_with_the_line(data: str, message: str) -> None:
    refused(data, "ply", message)


@pytest.mark.parametrize("ends", ["\n", " ", "\r\n", "\n\n"])
def test_records_need_no_lines_of_their_own(ends: str) -> None:
    body = PLY[len(PLY_HEADER) :].replace("\n", ends)
    assert is_cube(read(PLY_HEADER + body, "ply"))
