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
    """Return floats as decimals with the fewest places, each moved by at most the margin.

    A margin of 0 returns the numbers as they are.
    """
    if not margin > 0 or values.dtype.kind != "f":
        return values
    places = math.ceil(-math.log10(margin) - math.log10(2))
    return _where_near(values.astype(np.float64), places, margin)


def with_places(values: Floats, places: int) -> Floats:
    """Return float64 numbers rounded to so many places after the decimal point."""
    return _where_near(values, places, math.inf)


def _where_near(values: Floats, places: int, margin: float) -> Floats:
    """Return numbers as decimals where that moves them by at most the margin."""
    if abs(places) > _MOST_PLACES:
        return values
    with np.errstate(all="ignore"):  # a number may be too large to be scaled
        if abs(places) > _EXACT_POWER:
            nearest = [round(x, places) if math.isfinite(x) else x for x in values.ravel().tolist()]
            decimals = np.array(nearest).reshape(values.shape)
        else:
            decimals = np.round(values, places)
        near = np.isfinite(decimals) & (np.abs(decimals - values) <= margin)
    return np.where(near, decimals + 0.0, values)  # -0.0 becomes 0.0
