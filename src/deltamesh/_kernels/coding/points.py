"""Positions of anchors and isolated vertices, which are stored beside the deltas."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import Coder, code_number, code_raw
from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.jit import Int, kernel
from deltamesh_formats.array_types import Ints

LENGTHS = 64
SLOTS = 2 * LENGTHS
GAP, STEP = 0, 1
MIXERS = ((1, 255), (1, 255))
MODEL = Model(SLOTS, MIXERS)


@kernel
def _code_count(c: Coder, value: Int, kind: Int) -> Int:
    """Code a number >= 0."""
    return code_number(c, value + 1, kind * LENGTHS, kind, np.int64(LENGTHS - 1)) - 1


@kernel
def code_gaps(c: Coder, indices: Ints, n: Int) -> bool:
    """Code ascending indices below n, filled in when decoding; return whether they fit."""
    previous = np.int64(-1)
    for k in range(len(indices)):
        indices[k] = previous + 1 + _code_count(c, indices[k] - previous - 1, GAP)
        if indices[k] >= n or indices[k] < 0:
            return False
        previous = indices[k]
    return True


@kernel
def code_points(c: Coder, points: Ints, bits: Ints, extra: Ints) -> None:
    """Code `points` (k, 3), filled in when decoding, in `bits` (3,) and `extra` (k,) bits each."""
    for k in range(len(points)):
        for axis in range(3):
            points[k, axis] = code_raw(c, points[k, axis], bits[axis] + extra[k])


@kernel
def code_sorted_points(c: Coder, points: Ints, bits: Ints) -> bool:
    """Code `points` (k, 3) in ascending order of x, as steps in x; return whether x fits."""
    x = np.int64(0)
    for k in range(len(points)):
        x += _code_count(c, points[k, 0] - x, STEP)
        if x < 0 or x >> bits[0] > 0:
            return False
        points[k, 0] = x
        for axis in range(1, 3):
            points[k, axis] = code_raw(c, points[k, axis], bits[axis])
    return True
