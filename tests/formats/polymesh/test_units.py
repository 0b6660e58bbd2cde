"""Units of length, as mesh files name them."""

from __future__ import annotations

import pytest

from deltamesh_formats.polymesh.units import METRES, SYMBOLS, metres


def test_symbols_stand_for_units() -> None:
    assert set(SYMBOLS.values()) == set(METRES)


@pytest.mark.parametrize(
    ("unit", "length"),
    [
        ("millimeter", 0.001),
        ("inch", 0.0254),
        ("0.3 meter", 0.3),
        ("2e3 micron", 0.002),
        ("", None),
        ("parsec", None),
        ("0 meter", None),
        ("1e999 meter", None),
        ("1.2.3 meter", None),
        ("meter per second", None),
    ],
)
def test_a_unit_has_a_length(unit: str, length: float | None) -> None:
    assert metres(unit) == (None if length is None else pytest.approx(length))
