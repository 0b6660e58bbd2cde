"""Numbers of a format on a grid of integers, on which predictions of exact numbers are made.

A number m * base^(e - places) of a number format (`deltamesh._streams.number_formats`) is known by
its index in that format. The grid has the integer multiples of base^-grid. Within kernels,
`src/core/grid.c`; the functions here are for their tests.
"""

from __future__ import annotations

from ctypes import byref

import numpy as np

from deltamesh._kernels.core import call, constant, ints, number
from deltamesh_formats.array_types import Ints

BOUND = constant("DM_EXACT_BOUND")  # of the points on the grid

# Columns of the table of formats: the base; the places of the grid less those of the format; the
# digits; the usual length of a distance, at which the coder begins to ask.
FORMAT_SIZE = constant("DM_FORMAT_SIZE")

POWERS = np.array([10**i for i in range(19)], dtype=np.int64)


def index_at(formats: Ints, f: int, point: int) -> tuple[int, int]:
    """Return the index of the number next to a point, and its unit as a power on the grid."""
    index, unit = number(), number()
    call("dm_index_at", ints(formats[f], FORMAT_SIZE), point, byref(index), byref(unit))
    return index.value, unit.value


def point_of(formats: Ints, f: int, index: int) -> int:
    """Return the grid point of a number, rounded towards 0, within the bound."""
    point = number()
    call("dm_point_of", ints(formats[f], FORMAT_SIZE), index, byref(point))
    return point.value


def in_units(formats: Ints, f: int, unit: int, size: int) -> int:
    """Return a size on the grid in units of base^unit, or as many of them as fit."""
    units = number()
    call("dm_in_units", ints(formats[f], FORMAT_SIZE), unit, size, byref(units))
    return units.value
