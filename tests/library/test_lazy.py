"""Public names that are imported when they are first used."""

from __future__ import annotations

import sys

import pytest

from deltamesh._lazy import lazy_names

NAMES = {"fractions": ("Fraction",), "colorsys": ("rgb_to_hls", "hls_to_rgb")}


def test_names_come_from_their_modules(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "colorsys", raising=False)
    get, listed, public = lazy_names("some.package", NAMES)
    assert listed() == public == ["Fraction", "hls_to_rgb", "rgb_to_hls"]
    assert "colorsys" not in sys.modules
    assert get("rgb_to_hls")(0, 0, 0) == (0, 0, 0)
    assert get("Fraction") is __import__("fractions").Fraction
    assert "colorsys" in sys.modules


@pytest.mark.parametrize("name", ["fractions", "Fractions", "__path__"])
def test_other_names_are_no_attributes(name: str) -> None:
    get, _, _ = lazy_names("some.package", NAMES)
    with pytest.raises(AttributeError, match=f"'some.package' has no attribute '{name}'"):
        get(name)


def test_the_list_of_names_is_the_callers_own() -> None:
    _, listed, public = lazy_names("some.package", NAMES)
    listed().clear()
    assert listed() == public
