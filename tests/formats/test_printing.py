"""Text for people: printable names, numbers, tables."""

from __future__ import annotations

from annotated import ANY_TEXT
from hypothesis import given

from deltamesh_formats.printing import printable


@given(ANY_TEXT)
def test_escaped_text_is_one_printable_line(text: str) -> None:
    assert printable(text).isprintable()
    assert printable(text) == text or not text.isprintable()
