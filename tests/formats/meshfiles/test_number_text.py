"""Texts of numbers: read back, they are the same numbers, and none is longer than it must be."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as nps

from deltamesh_formats.meshfiles.number_text import number_texts, row_texts

KINDS = ("f2", "f4", "f8", "i4", "u1", "i8")


@given(st.sampled_from(KINDS), st.data())
def test_numbers_come_back(kind: str, data: st.DataObject) -> None:
    values = data.draw(nps.arrays(kind, st.integers(0, 8)))
    texts = number_texts(values)
    back = [np.dtype(kind).type(text) for text in texts]
    found = np.array(back, dtype=kind)
    assert np.array_equal(found, values, equal_nan=kind[0] == "f")
    has_sign = ~np.isnan(values)  # that of a NaN has no text
    assert (np.signbit(found) == np.signbit(values))[has_sign].all()


@pytest.mark.parametrize(
    ("value", "text"),
    [(np.float32(0.1), "0.1"), (np.float64(0.1), "0.1"), (np.uint8(200), "200")],
)
def test_texts_are_the_shortest(value: np.generic, text: str) -> None:
    assert number_texts(np.array([value])) == [text]
    assert len(number_texts(np.array([np.float64(np.float32(0.1))]))[0]) > 10


def test_rows_have_spaces_between() -> None:
    assert row_texts(np.array([[1, 2], [3, 4]])) == ["1 2", "3 4"]
    assert row_texts(np.zeros((0, 3))) == []
