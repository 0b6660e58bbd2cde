"""Colours as fractions, and attributes that are colours."""

from __future__ import annotations

import numpy as np
import pytest

from deltamesh_formats.polymesh.colours import as_fractions, is_rgb
from deltamesh_formats.polymesh.mesh import Attribute


@pytest.mark.parametrize(("kind", "largest"), [("u1", 255), ("u2", 65535), ("u4", 2**32 - 1)])
def test_normalized_integers_stand_for_fractions(kind: str, largest: int) -> None:
    values = np.array([[0, largest // 2, largest]], dtype=kind)
    found = as_fractions(values, normalized=True)
    np.testing.assert_allclose(found, [[0, 0.5, 1]], atol=0.5 / largest)
    assert (found[0, 0], found[0, 2]) == (0, 1)
    assert as_fractions(values, normalized=False) is values


def test_floats_are_fractions_already() -> None:
    values = np.array([[0.25, 2.0]], dtype=np.float32)
    assert as_fractions(values, normalized=True) is values


@pytest.mark.parametrize(
    ("role", "kind", "width", "normalized", "expected"),
    [
        ("colour", "u1", 3, True, True),
        ("colour", "f4", 4, False, True),
        ("colour", "u1", 4, False, False),
        ("colour", "f4", 2, False, False),
        ("other", "f4", 3, False, False),
    ],
)
def test_colours_have_three_or_four_fractions(
    role: str, kind: str, width: int, normalized: bool, expected: bool
) -> None:
    values = np.zeros((2, width), dtype=kind)
    assert is_rgb(Attribute("colour", "vertex", values, role, None, normalized)) is expected
