"""What a REPL and a notebook show of a file and of a mesh."""

from __future__ import annotations

from dataclasses import replace
from html.parser import HTMLParser

import meshes
import numpy as np
import pytest

import deltamesh
from deltamesh_formats.polymesh.mesh import Attribute, Parts

V, F = meshes.torus(9, 7)
MESH = deltamesh.from_arrays(V, F, vertex={"T": V[:, 0], "normal": V}, face={"R": F[:, 0]})
FILE = deltamesh.info(deltamesh.encode(V, F, bits=8, source_format="<b>&ply"))


class Tags(HTMLParser):
    """Whether tags close, and the text between them."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.text = ""
        self.feed(html)
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: object) -> None:
        assert tag in ("div", "table", "tr", "td", "th", "br")
        if tag != "br":
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data


def test_a_mesh_is_one_line_without_arrays() -> None:
    assert repr(MESH) == (
        "<PolyMesh: 63 vertices, 126 triangles; "
        "vertex data: T (float64), normal (float64 x 3); face data: R (int64)>"
    )
    assert repr(deltamesh.from_arrays(V, [[0, 1, 2, 3]])) == "<PolyMesh: 63 vertices, 1 quads>"
    mixed = deltamesh.from_arrays(V, [[0, 1, 2, 3, 4], [0, 1, 2]])
    assert repr(mixed) == "<PolyMesh: 63 vertices, 2 faces of 3 to 5 corners>"


def test_a_notebook_shows_the_numbers() -> None:
    text = Tags(MESH._repr_html_()).text
    assert "63 vertices, 126 triangles" in text
    assert "T (float64), normal (float64 x 3)" in text
    text = Tags(FILE._repr_html_()).text
    for number in (FILE.size, FILE.vertices, FILE.triangles, FILE.sections["CONN"].size):
        assert str(number) in text
    assert f"{8 * FILE.size / 63:.2f} bits per vertex" in text
    assert "normals" in text


def test_what_a_file_says_is_no_markup() -> None:
    assert "<b>" not in FILE._repr_html_()
    assert "from <b>&ply" in Tags(FILE._repr_html_()).text
    evil = "<script>alert(1)</script>\n\x1b[31m"
    mesh = replace(
        MESH,
        attributes=(Attribute(evil, "vertex", V),),
        parts=(Parts("group", (evil,), np.zeros(len(F), np.int64)),),
        metadata={evil: (evil,)},
        lost=(evil,),
    )
    shown = mesh._repr_html_()
    assert "<script>" not in shown
    assert "<script>alert(1)</script>" in Tags(shown).text
    for text in (shown, repr(mesh)):
        assert "\x1b" not in text
    assert "\n" not in repr(mesh)


def test_a_file_in_words_is_what_info_prints(capsys: pytest.CaptureFixture[str]) -> None:
    from deltamesh_cli.summary import described_container

    assert described_container("x.dmesh", FILE) == f"x.dmesh: {FILE}"
    assert len(repr(FILE)) < 3000
    assert "payload" not in repr(FILE)
