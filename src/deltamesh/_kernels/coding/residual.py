"""A vector of one or three signed integers at a vertex, and the contexts of its numbers.

They are levels, half logarithms of magnitudes around: what the neighbours had, what this vertex had
in the other coordinates, what the vertex before had.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding import numbers
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.numbers import LEVELS, code_number, level
from deltamesh._kernels.jit import Int, inlined, kernel

_Ints = NDArray[np.int64]

# Contexts of the length and of the sign.
MAGNITUDES, SIGNS = 6, 3
SLOTS = numbers.SLOTS
MIXERS = numbers.mixers(MAGNITUDES, SIGNS, 0)

# Indices into what a caller knows of a vertex: for each axis, sums over the known neighbours, the
# value of the vertex before, and a magnitude of the caller's choice; then for all axes: the
# neighbours known, two small classes of the caller's choice, below 4 and below 16, and what
# magnitude the vertex is known to have before its first coordinate.
SUM, ABSOLUTE, LAST, HINT = 0, 3, 6, 9
NEIGHBOURS, KIND, HINT_ALL, SPENT = 12, 13, 14, 15
KNOWN = 16


@kernel
def code_vector(c: Coder, value: _Ints, known: _Ints) -> None:
    """Code `value` (3,) or (1,), in place when decoding, in the light of `known` (KNOWN,)."""
    magnitudes, signs = np.empty(MAGNITUDES, np.int64), np.empty(SIGNS, np.int64)
    none = np.empty(0, np.int64)
    total = known[ABSOLUTE] + known[ABSOLUTE + 1] + known[ABSOLUTE + 2]
    spent = known[SPENT]  # and |v| of the coordinates before
    along = np.int64(0)  # their scalar product with the sum over the neighbours
    for axis in range(len(value)):
        set_magnitudes(magnitudes, known, axis, total, spent)
        set_signs(signs, known, axis, along)
        value[axis] = code_number(c, value[axis], np.int64(axis), magnitudes, signs, none, none)
        spent += abs(value[axis])
        along += known[SUM + axis] * value[axis]


@inlined
def set_magnitudes(contexts: _Ints, known: _Ints, axis: Int, total: Int, spent: Int) -> None:
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
def set_signs(contexts: _Ints, known: _Ints, axis: Int, along: Int) -> None:
    """Set the contexts of a sign, `SIGNS` of them."""
    mean, last = known[SUM + axis], known[LAST + axis]
    positive = 1 if mean > 0 else 0
    size = level(4 * abs(mean) // max(known[NEIGHBOURS], 1))
    agrees = 1 if along > 0 else (2 if along < 0 else 0)
    turn = 1 if last > 0 else (2 if last < 0 else 0)
    contexts[0] = positive * LEVELS + size
    contexts[1] = (agrees * 2 + positive) * LEVELS + size
    contexts[2] = ((turn * 3 + agrees) * 2 + positive) * 8 + size // 4
