"""Lines, tokens and numbers of texts, against str.split and float."""

from __future__ import annotations

import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from deltamesh_formats.errors import MeshError
from deltamesh_formats.meshfiles import text

texts = st.lists(
    st.sampled_from([b"v", b"12", b"-1.5e3", b"#", b" ", b"\t", b"\n", b"\r\n", b"\xff", b"nan"])
).map(b"".join)


@given(texts)
def test_tokens_are_those_of_split(data: bytes) -> None:
    lines = text.split_lines(data)
    expected = [line.split() for line in data.split(b"\n") if line.split()]
    tokens = [lines.token(i) for i in range(len(lines.token_starts))]
    assert tokens == [token for line in expected for token in line]
    assert lines.counts.tolist() == list(map(len, expected))
    assert [lines.token(i) for i in lines.first[:-1]] == [line[0] for line in expected]
    numbers = [i + 1 for i, line in enumerate(data.split(b"\n")) for _ in line.split()]
    assert [lines.number(int(at)) for at in lines.token_starts] == numbers


@given(texts)
def test_keywords_tell_tokens_apart(data: bytes) -> None:
    lines = text.split_lines(data)
    found = lines.keywords()
    assert found.tolist() == [int(text.keyword(lines.token(i))) for i in lines.first[:-1]]


def test_keywords_have_eight_bytes() -> None:
    assert text.keyword(b"property") != text.keyword(b"propert")
    assert text.keyword(b"abcdefgh") == text.keyword(b"abcdefghi")


@given(st.lists(st.lists(st.floats(), min_size=1, max_size=4), min_size=1, max_size=5))
def test_numbers_behind_keywords_are_read(rows: list[list[float]]) -> None:
    data = "\n".join("v " + " ".join(map(repr, row)) for row in rows).encode()
    lines = text.split_lines(data)
    buffer, tokens = text.without_first_tokens(lines, np.ones(len(rows), dtype=bool))
    found = text.read_numbers(buffer, lines, tokens)
    assert np.array_equal(found, np.array([x for row in rows for x in row]), equal_nan=True)


@pytest.mark.parametrize(
    ("data", "dtype", "message"),
    [
        (b"1\n2 x3", float, "line 2: 'x3' is not a number"),
        (b"1 2\n\n3.5", int, "line 3: '3.5' is not a whole number"),
        (b"1 0x10", float, "line 1: '0x10' is not a number"),
        (b"1-2", float, "."),
        (b"1_000", float, "'1_000' is not a number"),
        (b"\xff\xfe", float, "is not a number"),
    ],
)
def test_what_is_no_number_is_named_with_its_line(data: bytes, dtype: type, message: str) -> None:
    lines = text.split_lines(data)
    tokens = np.arange(len(lines.token_starts))
    with pytest.raises(MeshError, match=message):
        text.read_numbers(lines.buffer, lines, tokens, dtype)


def test_no_tokens_are_no_numbers() -> None:
    lines = text.split_lines(b"")
    assert text.read_numbers(lines.buffer, lines, np.arange(0)).shape == (0,)


def test_blanks_leave_every_byte_in_its_place() -> None:
    data = b"1 # a comment\n2"
    assert text.blanked(re.compile(rb"#[^\n]*"), data) == b"1            \n2"
    lines = text.split_lines(data)
    buffer = lines.buffer.copy()
    text.blank_tokens(buffer, lines, np.array([0, 3]))
    assert buffer.tobytes() == b"  # a        \n2"
    assert lines.buffer.tobytes() == data


@given(st.binary(max_size=30))
def test_names_in_any_encoding_come_back(raw: bytes) -> None:
    assert text.as_text(raw).encode(*text.ENCODING) == raw
    assert text.quoted(raw).isprintable()


@given(st.text(st.characters(exclude_categories=["Cs"]), max_size=20))
def test_a_name_on_one_line_does_not_continue(name: str) -> None:
    line = text.one_line(name)
    assert not re.search(r"[\r\n]", line)
    assert not line.endswith("\\")
