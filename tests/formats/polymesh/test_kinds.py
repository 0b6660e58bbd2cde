"""Kinds of parts: each has words."""

from __future__ import annotations

from typing import get_args

from deltamesh_formats.polymesh.kinds import KIND_WORDS, Kind


def test_every_kind_has_words_of_its_own() -> None:
    assert set(get_args(Kind)) == set(KIND_WORDS)
    assert len(set(KIND_WORDS.values())) == len(KIND_WORDS)
