"""Vectors of one or three signed integers at vertices, and the contexts of their numbers.

The contexts are levels, half logarithms of magnitudes around: those of the neighbours, of the other
coordinates of the vertex, and of the vertex before.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding import signed_integers
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.coding.signed_integers import LEVELS, code_signed, level
from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Ints

# Contexts of the length and of the sign.
MAGNITUDES, SIGNS = 6, 3
SLOTS = signed_integers.SLOTS
MIXERS = signed_integers.mixers(MAGNITUDES, SIGNS, 0)
MODEL = Model(SLOTS, MIXERS)

# Indices into what a caller knows about a vertex. For each axis: the sum over the known neighbours,
# the sum of their magnitudes, the value of the vertex before, and a magnitude of the caller's
# choice. Then for all axes: the number of known neighbours, two small classes of the caller's
# choice, below 4 and below 16, and the magnitude that the vertex is known to have before its first
# coordinate.
SUM, ABSOLUTE, LAST, HINT = 0, 3, 6, 9
NEIGHBOURS, KIND, HINT_ALL, SPENT = 12, 13, 14, 15
KNOWN = 16


@kernel
def code_vector(c: Coder, value: Ints, known: Ints) -> None:
    """Code `value` (3,) or (1,), in place when decoding, where `known` (KNOWN,) is known."""
    magnitudes, signs = np.empty(MAGNITUDES, np.int64), np.empty(SIGNS, np.int64)
    none = np.empty(0, np.int64)
    total = known[ABSOLUTE] + known[ABSOLUTE + 1] + known[ABSOLUTE + 2]
    spent = known[SPENT]  # and |v| of the coordinates before
    along = np.int64(0)  # their scalar product with the sum over the neighbours
    for axis in range(len(value)):
        set_magnitudes(magnitudes, known, axis, total, spent)
        set_signs(signs, known, axis, along)
        value[axis] = code_signed(c, value[axis], np.int64(axis), magnitudes, signs, none, none)
        spent += abs(value[axis])
        along += known[SUM + axis] * value[axis]


@inlined
def set_magnitudes(contexts: Ints, known: Ints, axis: Int, total: Int, spent: Int) -> None:
    """Set the contexts of a length, `MAGNITUDES` of them."""
    count, kind = max(known[NEIGHBOURS], 1), known[KIND]
    here = level(4 * known[ABSOLUTE + axis] // count)
    around = level(4 * total // count)
    before = level(spent)
    contexts[0] = here * 4 + kind
    contexts[1] = around * LEVELS + before
    contexts[2] = here * LEVELS + level(abs(known[LAST + axis]))
    contexts[3] = level(known[HINT + axis]) * LEVELS + here
    contexts[4] = (around * 16 + known[HINT_ALL]) * 4 + kind
    contexts[5] = ((here // 2) * 16 + before // 2) * 4 + kind


@inlined
def set_signs(contexts: Ints, known: Ints, axis: Int, along: Int) -> None:
    """Set the contexts of a sign, `SIGNS` of them."""
    mean, last = known[SUM + axis], known[LAST + axis]
    positive = 1 if mean > 0 else 0
    size = level(4 * abs(mean) // max(known[NEIGHBOURS], 1))
    agrees = 1 if along > 0 else (2 if along < 0 else 0)
    side = 1 if last > 0 else (2 if last < 0 else 0)
    contexts[0] = positive * LEVELS + size
    contexts[1] = (agrees * 2 + positive) * LEVELS + size
    contexts[2] = ((side * 3 + agrees) * 2 + positive) * 8 + size // 4
