"""What is put into the page: files that come back as they were, and words that stay words."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

from deltamesh import DeltameshError
from deltamesh._page import filling
from deltamesh._page.filling import PageFile, page_of
from deltamesh._page.text_of_bytes import as_bytes

TEMPLATE = "<title>{title}</title><script>{facts}</script>\n{meshes}\n"


@pytest.fixture(autouse=True)
def template(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    path = tmp_path / "page.html"
    path.write_text(TEMPLATE, encoding="utf-8")
    monkeypatch.setattr(filling, "PAGE", path)
    return path


def held(page: str) -> list[tuple[str, bytes]]:
    """The names and the bytes of the files in a page."""
    found = re.findall(r'data-name="([^"]*)"[^>]*>([^<]*)</script>', page)
    return [(name, as_bytes(text)) for name, text in found]


@pytest.mark.parametrize("size", [0, 1, 2, 3, 4, 5, 1000])
def test_files_are_in_it_as_they_are(size: int) -> None:
    data = np.random.default_rng(size).bytes(size)
    page = page_of([PageFile("a.dmesh", data, "", 7), PageFile("b", b"xy", "original", 8)], "t")
    assert held(page) == [("a.dmesh", data), ("b", b"xy")]
    assert page.index('data-role=""') < page.index('data-role="original"')
    assert 'data-size="7"' in page


def test_no_word_is_taken_for_html() -> None:
    evil = '"><script>alert(1)</script>&<'
    page = page_of([PageFile(evil, b"", "", 0)], evil, [[("</script><b>", "{meshes}")]])
    assert page.count("<script") == 2
    assert page.count("</script>") == 2
    assert "<b>" not in page
    assert page.startswith(
        "<title>&quot;&gt;&lt;script&gt;alert(1)&lt;/script&gt;&amp;&lt;</title>"
    )
    facts = re.search(r"<script>(.*)</script>\n", page)
    assert facts is not None
    assert json.loads(facts[1]) == {"compared": [[["</script><b>", "{meshes}"]]]}


def test_a_missing_page_is_named(template: Path) -> None:
    template.unlink()
    with pytest.raises(DeltameshError, match="made without the page: install ziglang"):
        page_of([], "t")
