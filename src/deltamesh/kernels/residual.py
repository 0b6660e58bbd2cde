"""A vector of three signed integers at a vertex, spelled in bits that several contexts predict.

Each number is the length of |v| in unary, the three bits below the highest, the rest as they are,
the sign: an Exp-Golomb code (Teuhola, "A compression method for clustered bit-vectors", 1978) of
which each bit that carries information has adaptive probabilities, as in CABAC (Marpe, Schwarz,
Wiegand, 2003), here mixed from several contexts. The contexts are levels, half logarithms of
magnitudes around: what the neighbours had, what this vertex had in the other coordinates.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.coder import CONTEXT, Coder, code_bit, code_raw
from deltamesh.kernels.jit import Int, inlined, kernel

LENGTHS = 32  # |v| < 2^31: checked before a value reaches the coder
LEVELS = 32
LIMIT = 255  # of the counts: measured best on the mean from 127, 255, 500, 1000

MAGNITUDES, MANTISSAS, SIGNS = 6, 2, 3  # contexts of each kind of bit
INPUTS = MAGNITUDES + MANTISSAS + SIGNS
MAGNITUDE_SLOTS = 2048 * LENGTHS  # of one context
MANTISSA_SLOTS = 8 * LENGTHS  # of one level
SIGN_SLOTS = 512

# Slots of one coordinate, by the kind of context.
MANTISSA_AT = MAGNITUDES * MAGNITUDE_SLOTS
SIGN_AT = MANTISSA_AT + (1 + LEVELS) * MANTISSA_SLOTS
AXIS_SLOTS = SIGN_AT + SIGNS * SIGN_SLOTS
SLOTS = 3 * AXIS_SLOTS

# Mixers of one coordinate: one for each bit of the length, the leading bits, the sign.
AXIS_MIXERS = LENGTHS + 2
MIXERS = 3 * (((MAGNITUDES, LIMIT),) * LENGTHS + ((MANTISSAS, LIMIT), (SIGNS, LIMIT)))

# Indices into what a caller knows of a vertex: for each axis, sums over the known neighbours, the
# value of the vertex before, and a magnitude of the caller's choice; then for all axes: the
# neighbours known, two small classes of the caller's choice, below 4 and below 16, and what
# magnitude the vertex is known to have before its first coordinate.
SUM, ABSOLUTE, LAST, HINT = 0, 3, 6, 9
NEIGHBOURS, KIND, HINT_ALL, SPENT = 12, 13, 14, 15
KNOWN = 16


@inlined
def level(x: Int) -> Int:
    """Return two levels an octave: 0 for 0, 1 for 1, 3, 4 for 2, 3, then 5 and 6 for 4 to 7."""
    if x <= 0:
        return np.int64(0)
    n = 0
    while (x >> (n + 1)) > 0:
        n += 1
    half = (x >> (n - 1)) & 1 if n > 0 else 0
    return np.int64(min(1 + 2 * n + half, LEVELS - 1))


@kernel
def code_vector(c: Coder, value: NDArray[np.int64], known: NDArray[np.int64]) -> None:
    """Code `value` (3,) or (1,), in place when decoding, in the light of `known` (KNOWN,)."""
    slots = np.empty(INPUTS, np.int64)
    total = known[ABSOLUTE] + known[ABSOLUTE + 1] + known[ABSOLUTE + 2]
    spent = known[SPENT]  # and |v| of the coordinates before
    along = np.int64(0)  # their scalar product with the sum over the neighbours
    for axis in range(len(value)):
        _set_magnitude_contexts(slots, known, axis, total, spent)
        _set_sign_contexts(slots, known, axis, along)
        value[axis] = _code_number(c, value[axis], slots, axis * AXIS_MIXERS)
        spent += abs(value[axis])
        along += known[SUM + axis] * value[axis]


@inlined
def _set_magnitude_contexts(
    slots: NDArray[np.int64], known: NDArray[np.int64], axis: Int, total: Int, spent: Int
) -> None:
    count, kind = max(known[NEIGHBOURS], 1), known[KIND]
    here = level(4 * known[ABSOLUTE + axis] // count)
    around = level(4 * total // count)
    before = level(spent)
    last = level(abs(known[LAST + axis]))
    hint = level(known[HINT + axis])
    base = axis * AXIS_SLOTS
    slots[0] = base + (here * 4 + kind) * LENGTHS
    slots[1] = base + MAGNITUDE_SLOTS + (around * LEVELS + before) * LENGTHS
    slots[2] = base + 2 * MAGNITUDE_SLOTS + (here * LEVELS + last) * LENGTHS
    slots[3] = base + 3 * MAGNITUDE_SLOTS + (hint * LEVELS + here) * LENGTHS
    pair = around * 16 + known[HINT_ALL]
    slots[4] = base + 4 * MAGNITUDE_SLOTS + (pair * 4 + kind) * LENGTHS
    pair = (here // 2) * 16 + before // 2
    slots[5] = base + 5 * MAGNITUDE_SLOTS + (pair * 4 + kind) * LENGTHS
    slots[6] = base + MANTISSA_AT
    slots[7] = base + MANTISSA_AT + (1 + here) * MANTISSA_SLOTS


@inlined
def _set_sign_contexts(
    slots: NDArray[np.int64], known: NDArray[np.int64], axis: Int, along: Int
) -> None:
    mean = known[SUM + axis]
    positive = 1 if mean > 0 else 0
    size = level(4 * abs(mean) // max(known[NEIGHBOURS], 1))
    agrees = 1 if along > 0 else (2 if along < 0 else 0)
    last = known[LAST + axis]
    turn = 1 if last > 0 else (2 if last < 0 else 0)
    first = axis * AXIS_SLOTS + SIGN_AT
    slots[8] = first + positive * LEVELS + size
    slots[9] = first + SIGN_SLOTS + (agrees * 2 + positive) * LEVELS + size
    slots[10] = first + 2 * SIGN_SLOTS + ((turn * 3 + agrees) * 2 + positive) * 8 + size // 4


@kernel
def _code_number(c: Coder, value: Int, slots: NDArray[np.int64], mixer: Int) -> Int:
    magnitude = abs(value)
    length = 0
    while magnitude >> length > 0:
        length += 1
    k = 0
    while k < LENGTHS - 1:
        for i in range(MAGNITUDES):
            c.state[CONTEXT + i] = slots[i] + k
        if code_bit(c, 1 if length > k else 0, mixer + k) == 0:
            break
        k += 1
    if k == 0:
        return 0
    magnitude = _code_mantissa(c, magnitude, k, slots, mixer + LENGTHS)
    for i in range(SIGNS):
        c.state[CONTEXT + i] = slots[MAGNITUDES + MANTISSAS + i]
    negative = code_bit(c, 1 if value < 0 else 0, mixer + LENGTHS + 1)
    return -magnitude if negative == 1 else magnitude


@kernel
def _code_mantissa(
    c: Coder, magnitude: Int, length: Int, slots: NDArray[np.int64], mixer: Int
) -> Int:
    """Code the bits of a magnitude below its highest, the first three in their contexts."""
    result = 1
    modelled = min(length - 1, 3)
    for j in range(modelled):
        node = 8 * length + result  # result is 1; 2, 3; 4 to 7
        c.state[CONTEXT] = slots[MAGNITUDES] + node
        c.state[CONTEXT + 1] = slots[MAGNITUDES + 1] + node
        bit = code_bit(c, (magnitude >> (length - 2 - j)) & 1, mixer)
        result = 2 * result + bit
    rest = length - 1 - modelled
    return (result << rest) | code_raw(c, magnitude & ((1 << rest) - 1), rest)
