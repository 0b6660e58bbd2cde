"""Text of a file: names of parts and metadata."""

from __future__ import annotations

import pytest

from deltamesh_formats.container import texts
from deltamesh_formats.container.payload_layout import BLOCK_PLAIN, BLOCK_ZSTD, MAX_TEXT
from deltamesh_formats.container.texts import Texts
from deltamesh_formats.errors import MeshError


def test_repetitive_text_is_packed() -> None:
    names = [f"Object_{i:04}_LOD0_Material" for i in range(400)]
    block = texts.write_texts(Texts((), {"comments": tuple(names)}, ()))
    assert block[0] == BLOCK_ZSTD
    assert len(block) < sum(map(len, names)) / 20
    assert texts.write_texts(Texts((), {"a": ("b",)}, ()))[0] == BLOCK_PLAIN


def test_more_text_than_a_file_holds_is_refused() -> None:
    with pytest.raises(MeshError, match="names and metadata"):
        texts.write_texts(Texts((), {"a": ("x" * MAX_TEXT,)}, ()))
