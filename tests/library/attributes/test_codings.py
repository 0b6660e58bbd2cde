"""Values of attributes as integers, and back."""

from __future__ import annotations

import numpy as np
import pytest

from deltamesh._attributes.candidates import AttributeSettings, candidate_codings
from deltamesh._attributes.codings import (
    check_codes,
    from_codes,
    margin_of,
    mixed,
    to_codes,
    unmixed,
)
from deltamesh_formats.errors import FormatError
from deltamesh_formats.polymesh.mesh import Attribute

RNG = np.random.default_rng(5)
SETTINGS = AttributeSettings(12, 10, lossless=False, positions=np.zeros((0, 3)), tolerance=0.0)


@pytest.mark.parametrize("kind", ["i1", "i2", "i4", "i8", "u1", "u2", "u4", "u8", "?"])
def test_integers_come_back(kind: str) -> None:
    values = RNG.integers(0, 256, (40, 3 * np.dtype(kind).itemsize)).astype("u1").view(kind)
    values = values != 0 if kind == "?" else values
    for entry in candidate_codings(Attribute("a", "vertex", values), values, SETTINGS):
        codes = to_codes(entry, values)
        check_codes(entry, codes)
        back = from_codes(entry, codes)
        assert back.dtype == values.dtype
        np.testing.assert_array_equal(back, values)
        assert margin_of(entry) == 0


@pytest.mark.parametrize("kind", ["f4", "f8"])
def test_points_of_a_grid_come_back_within_half_a_step(kind: str) -> None:
    values = RNG.normal(size=(40, 2)).astype(kind)
    exact, grid = candidate_codings(Attribute("uv", "vertex", values, "uv"), values, SETTINGS)
    assert from_codes(exact, to_codes(exact, values)).tobytes() == values.tobytes()
    errors = np.abs(from_codes(grid, to_codes(grid, values)).astype(float) - values.astype(float))
    assert errors.max() == grid.error <= 0.51 / grid.density
    assert 0 < margin_of(grid) < grid.error / 50


def test_integers_that_no_value_has_are_refused() -> None:
    values = np.arange(6, dtype="u1").reshape(3, 2)
    (entry,) = candidate_codings(Attribute("a", "vertex", values), values, SETTINGS)
    for code in (-1, 1 << entry.bits):
        codes = to_codes(entry, values)
        codes[1, 0] = code
        with pytest.raises(FormatError, match="attribute integer out of range"):
            check_codes(entry, codes)


def test_mixing_is_undone() -> None:
    columns = RNG.integers(0, 256, (20, 4))
    np.testing.assert_array_equal(unmixed(mixed(columns)), columns)
    assert (mixed(columns)[:, 0] == columns[:, 0] - columns[:, 1]).all()
