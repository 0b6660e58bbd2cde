"""Texts of numbers: the shortest that are read as the same numbers, and rounding before that."""

from __future__ import annotations

import math
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from deltamesh_formats.array_types import Floats

# Powers of ten up to this one are exact: a number scaled by one, rounded and scaled back is the
# float64 nearest to a decimal.
_EXACT_POWER: Final = 22
# Decimal places beyond which no float64 has digits.
_MOST_PLACES: Final = 330


def number_texts(values: NDArray[Any], *, points: bool = False) -> list[str]:
    """Return the shortest text of each number of an array, flattened, that is read as that number.

    Readers of text read float64: a float32 has the digits of the float64 that it equals. Floats
    that are whole numbers have a point only if `points`.
    """
    texts = list(map(repr, values.ravel().tolist()))
    if values.dtype.kind == "f" and not points:
        return [text.removesuffix(".0") for text in texts]
    return texts


def row_texts(values: NDArray[Any], *, points: bool = False) -> list[str]:
    """Return the numbers of each row of an array, (rows, width), with spaces between."""
    width = values.shape[1]
    flat = number_texts(values, points=points)
    return list(map(" ".join, zip(*(flat[i::width] for i in range(width)), strict=True)))


def rounded(values: NDArray[Any], margin: float) -> NDArray[Any]:
    """Return floats as decimals with few places, each moved by at most the margin.

    All have as many places as that takes, and those that are near to a decimal with one or two
    places less have these. A margin of 0 returns the numbers as they are.
    """
    if not margin > 0 or values.dtype.kind != "f":
        return values
    exact = values.astype(np.float64)
    most = math.ceil(-math.log10(margin) - math.log10(2))
    found = exact
    for places in (most, most - 1, most - 2):
        decimals = with_places(exact, places)
        with np.errstate(invalid="ignore"):
            near = np.abs(decimals - exact) <= margin
        found = np.where(near, decimals, found)
    return found


def with_places(values: Floats, places: int) -> Floats:
    """Return float64 numbers rounded to so many places after the decimal point; 0.0 for -0.0."""
    if abs(places) > _MOST_PLACES:
        return values
    with np.errstate(all="ignore"):  # a number may be too large to be scaled
        if abs(places) > _EXACT_POWER:
            nearest = [round(x, places) if math.isfinite(x) else x for x in values.ravel().tolist()]
            decimals = np.array(nearest).reshape(values.shape)
        else:
            decimals = np.round(values, places)
        # A float64 has no digits beyond 2^52 units of the last place.
        scaled = np.abs(values) * 10.0 ** min(places, 300) < 2.0**52
    return np.where(scaled & np.isfinite(decimals), decimals + 0.0, values)
