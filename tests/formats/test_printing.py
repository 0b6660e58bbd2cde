"""Text for people: printable names, numbers, tables."""

from __future__ import annotations

import pytest
from annotated import ANY_TEXT
from hypothesis import given

from deltamesh_formats.printing import html_table, number, printable, table


@given(ANY_TEXT)
def test_escaped_text_is_one_printable_line(text: str) -> None:
    assert printable(text).isprintable()
    assert printable(text) == text or not text.isprintable()


def test_tables_are_aligned() -> None:
    rows = [("name", "bytes"), ("a", "12"), ("longer", "1")]
    assert table(rows) == "  name    bytes\n  a          12\n  longer      1"
    assert table([("a", "")], indent="") == "a"


def test_cells_of_html_are_escaped() -> None:
    text = html_table([("<b>", "&")], ("x", '"y"'))
    assert "<th>x</th><th>&quot;y&quot;</th>" in text
    assert "<td>&lt;b&gt;</td><td>&amp;</td>" in text
    assert "<th>" not in html_table([("a",)])


@pytest.mark.parametrize(("value", "text"), [(0, "0"), (1234.56, "1235"), (1e-9 / 3, "3.333e-10")])
def test_numbers_have_four_digits(value: float, text: str) -> None:
    assert number(value) == text
