"""Text in UTF-8 with line feeds: marks, wide encodings, line ends, what is left at the end."""

from __future__ import annotations

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import plain_text


@pytest.mark.parametrize(
    "encoding",
    ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "utf-32"],
)
def test_encodings(encoding: str) -> None:
    text = "v 1 2 3\no B\u00f6x \u4e2d \U0001f600\n"
    assert plain_text.utf8(text.encode(encoding)) == text.encode()


@pytest.mark.parametrize("mark", [b"\xff\xfe", b"\xfe\xff"])
def test_marks_of_both_orders(mark: bytes) -> None:
    order = "utf-16-le" if mark == b"\xff\xfe" else "utf-16-be"
    assert plain_text.utf8(mark + "f 1 2 3\r\n".encode(order)) == b"f 1 2 3\r\n"


@pytest.mark.parametrize(
    ("data", "name"),
    [
        (b"\xff\xfev\0 \0\x00", "UTF-16"),
        (b"\xff\xfe\x00\xd8v\0", "UTF-16"),
        (b"\xff\xfe\0\0v\0\0", "UTF-32"),
    ],
)
def test_what_is_not_valid_is_refused(data: bytes, name: str) -> None:
    with pytest.raises(MeshError, match=f"it is {name} text, but not valid"):
        plain_text.utf8(data)


@pytest.mark.parametrize(
    "data", [b"", b"v", b"v 1 2 3\n", b"\0\0\0\0", b"v\0 1", b"OFF\n", b"\xe9\xff\xfe", bytes(80)]
)
def test_other_bytes_are_none_of_these(data: bytes) -> None:
    assert plain_text.wide_encoding(data) is None
    assert plain_text.utf8(data) is data


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (b"a\rb\r", b"a\nb\n"),
        (b"a\r\nb\r", b"a \nb\n"),
        (b"a\r\nb\r\n", b"a\r\nb\r\n"),
        (b"a\rb\nc", b"a\nb\nc"),
        (b"a\r\r\nb\n", b"a  \nb\n"),
        (b"a\r\n\rb", b"a \n\nb"),
        (b"a\nb", b"a\nb"),
        (b"\r", b"\n"),
    ],
)
def test_every_line_end_has_a_line_feed(data: bytes, expected: bytes) -> None:
    assert plain_text.with_line_feeds(data) == expected


@given(st.text("ab\r\n", max_size=20))
def test_lines_keep_their_bytes_and_their_number(text: str) -> None:
    made = plain_text.with_line_feeds(text.encode())
    assert len(made) == len(text)
    lines = re.split(r"\r\r\n|\r\n|\r|\n", text)
    assert [line.rstrip(b" \r").decode() for line in made.split(b"\n")] == lines


@pytest.mark.parametrize("tail", [b"\x1a", b"\n\x1a\n", bytes(300), b"\r\n\x1a\0\0 \r\n"])
def test_marks_at_the_end_are_left_out(tail: bytes) -> None:
    assert plain_text.without_end_marks(b"f 1 2 3" + tail) == b"f 1 2 3\n"


@pytest.mark.parametrize("data", [b"", b"f 1 2 3", b"f 1 2 3 \n\n", b"a\0b\n", b"\x1a b"])
def test_other_ends_stay(data: bytes) -> None:
    assert plain_text.without_end_marks(data) is data


def test_marks_of_files_that_were_put_together_are_blanks() -> None:
    data = b"\xef\xbb\xbfv 0 0 0\n\xef\xbb\xbfv 1 0 0\no \xef\xbb\xbf\n"
    assert plain_text.plain(data) == b"v 0 0 0\n   v 1 0 0\no \xef\xbb\xbf\n"
