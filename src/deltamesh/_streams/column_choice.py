"""Choice of the number formats and conversions of three columns, by estimates and by sizes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

import numpy as np

from deltamesh._graph.elements import Elements
from deltamesh._kernels.coding.exact import RAW
from deltamesh._streams.conversion_choice import choose_conversion
from deltamesh._streams.exact import DOUBLE, SINGLE, encode_numbers, parallelogram_errors
from deltamesh._streams.format_choice import choose_formats
from deltamesh._streams.number_formats import RAW_ONLY, ColumnFormats, to_indices
from deltamesh_formats.array_types import Bools, Floats, Ints

# Where estimates differ less, as a ratio, streams are written and the smaller one is taken.
_SURE: Final = 0.75


def choose_columns(
    elements: Elements, V: Floats, usable: Bools, raw: Ints, single: bool
) -> list[ColumnFormats]:
    """Choose the number formats of three columns, and conversions where these save bytes.

    Parameters
    ----------
    elements : Elements
    V : float64 (n, 3)
    usable, raw : bool (n, 3), int64 (n, 3)
        Which values may be in a number format, and the bits of the others.
    single : bool
        Whether all values are float32.
    """
    errors = parallelogram_errors(V, elements)
    plain, converted, costs = [], [], np.zeros(2)
    for a in range(3):
        some = usable[:, a]
        values, known = V[some, a], errors[np.isfinite(errors[:, a]), a]
        if not len(values):
            plain.append(RAW_ONLY)
            converted.append(RAW_ONLY)
            continue
        cost, column = choose_formats(values, known, single)
        less, other = choose_conversion(values, known, single, cost, column)
        plain.append(replace(column, raw=column.raw or not some.all()))
        converted.append(replace(other, raw=other.raw or not some.all()))
        costs += cost, less
    if converted == plain or costs[1] <= _SURE * costs[0]:
        return converted
    width = SINGLE if single else DOUBLE
    streams = [
        encode_numbers(elements, width, columns, *numbers_of(V, usable, raw, columns, single))
        for columns in (plain, converted)
    ]
    return converted if len(streams[1]) < len(streams[0]) else plain


def numbers_of(
    V: Floats, usable: Bools, raw: Ints, columns: Sequence[ColumnFormats], single: bool
) -> tuple[Ints, Ints, Ints]:
    """Return choices, indices and deviations, int64 (n, 3) each, of values in these formats."""
    choices, indices, deviations = np.empty((3, *V.shape), dtype=np.int64)
    for a, column in enumerate(columns):
        clean = np.where(usable[:, a], V[:, a], 0.0)
        found = to_indices(clean, column, single)
        choices[:, a], indices[:, a], deviations[:, a] = found
    choices[~usable] = RAW
    deviations[~usable] = 0
    return choices, np.where(choices == RAW, raw, indices), deviations
