"""Numbers of a format on a grid of integers, on which predictions of exact numbers are made.

A number m * base^(e - places) of a number format (`deltamesh._streams.number_formats`) is known by
its index in that format. The grid has the integer multiples of base^-grid.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.jit import Int, inlined
from deltamesh_formats.array_types import Ints

BOUND = 1 << 56  # of the points on the grid

# Columns of the table of formats: the base; the places of the grid less those of the format; the
# digits; the usual length of a distance, at which the coder begins to ask.
BASE, OFFSET, DIGITS, USUAL, FORMAT_SIZE = range(5)

POWERS = np.array([10**i for i in range(19)], dtype=np.int64)


@inlined
def index_at(formats: Ints, f: Int, point: Int) -> tuple[Int, Int]:
    """Return the index of the number next to a point, and its unit as a power on the grid."""
    offset, digits = formats[f, OFFSET], formats[f, DIGITS]
    size, length = abs(point), np.int64(0)
    if formats[f, BASE] == 2:
        while size >> length > 0:
            length += 1
        e = max(length - offset - digits, 0)
        unit = e + offset
        if unit > 0:
            m = ((size >> min(unit - 1, 62)) + 1) >> 1
        else:
            m = size << -unit if size > 0 else np.int64(0)  # fewer digits than the format has
        index = (e << (digits - 1)) + m
    else:
        while length < 18 and size >= POWERS[length]:
            length += 1
        e = max(length - offset - digits, 0)
        unit = e + offset
        m = (size + POWERS[unit] // 2) // POWERS[unit]
        index = e * 9 * POWERS[digits - 1] + m
    return (-index if point < 0 else index), unit


@inlined
def point_of(formats: Ints, f: Int, index: Int) -> Int:
    """Return the grid point of a number, rounded towards 0, within the bound."""
    offset, digits = formats[f, OFFSET], formats[f, DIGITS]
    size: Int = abs(index)
    point: Int = BOUND
    if formats[f, BASE] == 2:
        e = max((size >> (digits - 1)) - 1, 0)
        m, unit = size - (e << (digits - 1)), e + offset
        if unit <= 0:
            point = min(m >> min(-unit, 62), BOUND)
        elif (unit < 56 and m < BOUND >> unit) or m == 0:
            point = m << min(unit, 56)
    else:
        top = POWERS[digits - 1]
        e = (size - top) // (9 * top) if size >= top else 0
        m, unit = size - e * 9 * top, e + offset
        if m <= BOUND // POWERS[min(unit, 18)]:
            point = m * POWERS[min(unit, 18)]
    return -point if index < 0 else point


@inlined
def in_units(formats: Ints, f: Int, unit: Int, size: Int) -> Int:
    """Return a size on the grid in units of base^unit, or as many of them as fit."""
    if formats[f, BASE] == 10:
        return size // POWERS[unit]
    if unit >= 0:
        return size >> min(unit, 62)
    return min(size, 1 << 29) << min(-unit, 32)
