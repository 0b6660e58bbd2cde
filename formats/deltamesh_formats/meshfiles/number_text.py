"""Texts of numbers: the shortest that are read as the same numbers."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray


def number_texts(values: NDArray[Any]) -> list[str]:
    """Return the shortest text of each number of an array, flattened, that is unique in its type.

    float32 and float16 are shorter than float64; whole numbers have no point.
    """
    flat = values.ravel()
    if flat.dtype.kind == "f" and flat.dtype.itemsize < 8:
        return list(map(str, flat))
    return list(map(repr, flat.tolist()))


def row_texts(values: NDArray[Any]) -> list[str]:
    """Return the numbers of each row of an array, (rows, width), with spaces between."""
    width = values.shape[1]
    flat = number_texts(values)
    return list(map(" ".join, zip(*(flat[i::width] for i in range(width)), strict=True)))
