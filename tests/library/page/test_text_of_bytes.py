"""Bytes as text: any come back, and nothing in it means anything to HTML."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from deltamesh._page.text_of_bytes import LETTERS, as_bytes, as_text


@given(st.binary(max_size=200))
def test_bytes_come_back(data: bytes) -> None:
    text = as_text(data)
    assert as_bytes(text) == data
    assert {*text} <= {*LETTERS}
    assert len(text) <= 2 * -(-8 * len(data) // 13)


def test_every_size_comes_back() -> None:
    for size in range(60):
        for data in (bytes(size), b"\xff" * size):
            assert as_bytes(as_text(data)) == data


def test_letters_mean_nothing_to_html() -> None:
    assert len(LETTERS) == 91
    assert not {*LETTERS} & {*"<>& \n"}
