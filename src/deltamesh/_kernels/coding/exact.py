"""Numbers to the last bit: the distance of each from a prediction, in units of its own format.

A number m * base^(e - places) of a number format (`deltamesh._streams.number_formats`) is known by
its index in that format. Parallelograms predict a point on a grid of integers; the coded distance
is the number of indices between the number next to that point and the true one. After
P. Lindstrom, M. Isenburg, "Fast and efficient compression of floating-point data", IEEE TVCG 12(5),
2006, and M. Isenburg, P. Lindstrom, J. Snoeyink, "Lossless compression of predicted floating-point
geometry", CAD 37(8), 2005, whose contexts are exponents. Here the errors around are measured in the
unit that the format has at the prediction: that they were made where numbers lie denser or less
dense then makes no difference.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit, code_raw
from deltamesh._kernels.coding.grid import BOUND, USUAL, in_units, index_at, point_of
from deltamesh._kernels.coding.models import layout
from deltamesh._kernels.coding.signed_integers import LEVELS, level
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Ints

# Parallelograms and neighbours of a vertex that are looked at: sums of so many points of the grid
# stay within 64 bits.
MOST = 8

# Choices of a coordinate: the first format, the second, its raw bits, a negative zero.
FIRST, SECOND, RAW, NEGATIVE_ZERO = range(4)

# Columns of the table of axes: the row of its first format, the number of formats, whether there
# are raw coordinates and negative zeros.
FORMAT_AT, FORMATS, HAS_RAW, HAS_ZEROS = range(4)

LENGTHS = 63  # of a distance, in bits; indices are below 2^61
WINDOW = 8  # levels distinguish sizes down to 2^-8 of the usual
LIMIT = 255

MAGNITUDES, MANTISSAS, SIGNS = 6, 2, 3  # contexts of each kind of bit
INPUTS = MAGNITUDES + MANTISSAS + SIGNS
MAGNITUDE_SLOTS = 1024 * LENGTHS  # of one context
MANTISSA_SLOTS = 8 * LENGTHS  # of one level
SIGN_SLOTS = 32

# Slots and mixers of one format.
_, MANTISSA_AT, SIGN_AT, FORMAT_SLOTS = layout(
    (MAGNITUDES, MAGNITUDE_SLOTS), (1 + LEVELS, MANTISSA_SLOTS), (SIGNS, SIGN_SLOTS)
)
FORMAT_MIXERS = ((MAGNITUDES, LIMIT),) * LENGTHS + ((MANTISSAS, LIMIT), (SIGNS, LIMIT))

# Slots and mixers of the choice between the formats, of one axis.
CHOICES = 3
CHOICE_SLOTS = 128
AXIS_SLOTS = 3 * CHOICES * CHOICE_SLOTS
AXIS_MIXERS = ((CHOICES, LIMIT),) * 3
# Those of the formats come after those of the axes.
FORMATS_AT = 3 * AXIS_SLOTS


@kernel
def code_exact(
    c: Coder,
    indptr: Ints,
    indices: Ints,
    first: Ints,
    corners: Ints,
    axes: Ints,
    formats: Ints,
    width: Int,
    choices: Ints,
    values: Ints,
) -> None:
    """Code `choices` and `values` (n, 3), filled in place when decoding.

    A value is an index or, where it is raw, `width` bits. Neighbours are as
    `adjacency.adjacency` returns them, parallelograms as `parallelograms.parallelograms` does.
    """
    n = len(values)
    grid = np.zeros((n, 3), np.int64)
    errors = np.zeros((n, 3), np.int64)  # prediction to truth, on the grid
    slots = np.zeros(INPUTS, np.int64)
    for i in range(n):
        before, chosen_before = np.int64(0), np.int64(0)
        for axis in range(3):
            point, spread = _predict(indptr, indices, first, corners, grid, i, axis)
            around = _around(indptr, indices, errors, choices, i, axis)
            chosen = _code_choice(c, axes, choices, i, axis, around, chosen_before)
            chosen_before = 3 * chosen_before + chosen
            if choices[i, axis] != NEGATIVE_ZERO:
                choices[i, axis] = chosen
            if chosen == RAW:
                values[i, axis] = _code_bits(c, values[i, axis], width)
                grid[i, axis] = point
                continue
            f = axes[axis, FORMAT_AT] + chosen
            index, unit = index_at(formats, f, point)
            error = errors[i - 1, axis] if i > 0 else np.int64(0)
            kind = min(first[i + 1] - first[i], 3)
            _set_contexts(slots, formats, f, unit, around, kind, spread, error, before)
            mixer = 3 * len(AXIS_MIXERS) + f * len(FORMAT_MIXERS)
            distance = _code_distance(c, values[i, axis] - index, slots, mixer, formats[f, USUAL])
            values[i, axis] = index + distance
            if index + distance == 0 and chosen == FIRST and axes[axis, HAS_ZEROS] == 1:
                choices[i, axis] = _code_zero(c, indptr, indices, choices, i, axis)
            grid[i, axis] = point_of(formats, f, index + distance)
            errors[i, axis] = min(max(grid[i, axis] - point, -BOUND), BOUND)
            size = level(abs(distance) >> max(formats[f, USUAL] - WINDOW, 0))
            before = size if axis == 0 else (before + size + 1) // 2


@inlined
def _predict(
    indptr: Ints, indices: Ints, first: Ints, corners: Ints, grid: Ints, i: Int, axis: Int
) -> tuple[Int, Int]:
    """Return the mean of the parallelograms, else of the known neighbours, and their spread."""
    total, low, high = np.int64(0), np.int64(4 * BOUND), np.int64(-4 * BOUND)
    count = min(first[i + 1] - first[i], MOST)
    for at in range(first[i], first[i] + count):
        a, b, o = corners[at, 0], corners[at, 1], corners[at, 2]
        point = grid[a, axis] + grid[b, axis] - grid[o, axis]
        total += point
        low, high = min(low, point), max(high, point)
    if count > 0:
        point = (2 * total + count) // (2 * count)
        return min(max(point, -BOUND), BOUND), high - low
    for at in range(indptr[i], indptr[i + 1]):
        if indices[at] >= i or count == MOST:
            break  # neighbours ascend
        total += grid[indices[at], axis]
        count += 1
    if count > 0:
        return total // count, np.int64(0)
    return (grid[i - 1, axis] if i > 0 else np.int64(0)), np.int64(0)


@inlined
def _around(
    indptr: Ints, indices: Ints, errors: Ints, choices: Ints, i: Int, axis: Int
) -> tuple[Int, Int, Int, Int]:
    """Return four numbers about the known neighbours.

    These are the sum of the sizes of their errors, and of the signs; how many of them are raw or in
    the second format; how many there are.
    """
    total, signs, others, count = np.int64(0), np.int64(0), np.int64(0), np.int64(0)
    for at in range(indptr[i], indptr[i + 1]):
        j = indices[at]
        if j >= i or count == MOST:
            break
        error = errors[j, axis]
        total += abs(error)
        signs += np.int64(error > 0) - np.int64(error < 0)
        others += np.int64(choices[j, axis] == SECOND) + np.int64(choices[j, axis] == RAW)
        count += 1
    return total, signs, others, count


@inlined
def _code_choice(
    c: Coder,
    axes: Ints,
    choices: Ints,
    i: Int,
    axis: Int,
    around: tuple[Int, Int, Int, Int],
    chosen_before: Int,
) -> Int:
    """Code whether a coordinate is in the first format, the second, or raw.

    `chosen_before` has the choices of the axes before, as digits.
    """
    _, _, others, count = around
    given = choices[i, axis]
    last = choices[i - 1, axis] if i > 0 else np.int64(FIRST)
    base = axis * AXIS_SLOTS
    share = 4 * others // max(count, 1)
    c.state[CONTEXT] = base + 16 * share + chosen_before
    c.state[CONTEXT + 1] = base + CHOICE_SLOTS + (MOST + 1) * others + count
    c.state[CONTEXT + 2] = base + 2 * CHOICE_SLOTS + 16 * last + chosen_before
    formats, raw = axes[axis, FORMATS], axes[axis, HAS_RAW]
    mixer = axis * len(AXIS_MIXERS)
    if formats == 0:
        return np.int64(RAW)
    if formats + raw == 1:
        return np.int64(FIRST)
    other = np.int64(given == SECOND) + np.int64(given == RAW)
    if code_bit(c, other, mixer) == 0:
        return np.int64(FIRST)
    if formats == 1:
        return np.int64(RAW)
    if raw == 0:
        return np.int64(SECOND)
    for k in range(CHOICES):
        c.state[CONTEXT + k] += CHOICES * CHOICE_SLOTS
    return np.int64(SECOND) + code_bit(c, np.int64(given == RAW), mixer + 1)


@inlined
def _code_bits(c: Coder, value: Int, width: Int) -> Int:
    """Code a number as it is, the highest bits first."""
    high = code_raw(c, (value >> 32) & 0xFFFFFFFF, np.int64(width - 32))
    return (high << 32) | code_raw(c, value & 0xFFFFFFFF, np.int64(32))


@inlined
def _code_zero(c: Coder, indptr: Ints, indices: Ints, choices: Ints, i: Int, axis: Int) -> Int:
    """Code whether a zero is negative."""
    alike = np.int64(0)
    for at in range(indptr[i], min(indptr[i + 1], indptr[i] + MOST)):
        alike += np.int64(indices[at] < i and choices[indices[at], axis] == NEGATIVE_ZERO)
    base = axis * AXIS_SLOTS + 2 * CHOICES * CHOICE_SLOTS
    c.state[CONTEXT] = base
    c.state[CONTEXT + 1] = base + CHOICE_SLOTS + alike
    c.state[CONTEXT + 2] = base + 2 * CHOICE_SLOTS + (choices[i - 1, axis] if i > 0 else 0)
    negative = code_bit(c, np.int64(choices[i, axis] == NEGATIVE_ZERO), axis * len(AXIS_MIXERS) + 2)
    return np.int64(NEGATIVE_ZERO if negative == 1 else FIRST)


@inlined
def _set_contexts(
    slots: Ints,
    formats: Ints,
    f: Int,
    unit: Int,
    around: tuple[Int, Int, Int, Int],
    kind: Int,
    spread: Int,
    error: Int,
    before: Int,
) -> None:
    """Set the slots of a distance; `error` is that of the vertex before."""
    total, signs, _, count = around
    shift = max(formats[f, USUAL] - WINDOW, 0)
    here = level(in_units(formats, f, unit, 4 * total // max(count, 1)) >> shift)
    hint = level(in_units(formats, f, unit, spread) >> shift)
    latest = level(in_units(formats, f, unit, abs(error)) >> shift)
    base = FORMATS_AT + f * FORMAT_SLOTS
    slots[0] = base + (here * 4 + kind) * LENGTHS
    slots[1] = base + MAGNITUDE_SLOTS + (here * LEVELS + before) * LENGTHS
    slots[2] = base + 2 * MAGNITUDE_SLOTS + (here * LEVELS + latest) * LENGTHS
    slots[3] = base + 3 * MAGNITUDE_SLOTS + (hint * LEVELS + here) * LENGTHS
    pair = (hint // 2) * 16 + before // 2
    slots[4] = base + 4 * MAGNITUDE_SLOTS + (pair * 4 + kind) * LENGTHS
    pair = (here // 2) * 16 + before // 2
    slots[5] = base + 5 * MAGNITUDE_SLOTS + (pair * 4 + kind) * LENGTHS
    slots[6] = base + MANTISSA_AT
    slots[7] = base + MANTISSA_AT + (1 + here) * MANTISSA_SLOTS
    side = np.int64(signs > 0) + 2 * np.int64(signs < 0)
    last = np.int64(error > 0) + 2 * np.int64(error < 0)
    base += SIGN_AT
    slots[8] = base + side
    slots[9] = base + SIGN_SLOTS + signs + MOST
    slots[10] = base + 2 * SIGN_SLOTS + 3 * last + side


@kernel
def _code_distance(c: Coder, value: Int, slots: Ints, mixer: Int, usual: Int) -> Int:
    """Code the length of |value|, asked from the usual one up or down, its other bits, its sign."""
    magnitude, length = abs(value), np.int64(0)
    while magnitude >> length > 0:
        length += 1
    k = usual
    if _is_longer(c, length, k, slots, mixer):
        k += 1
        while k < LENGTHS - 1 and _is_longer(c, length, k, slots, mixer):
            k += 1
    else:
        while k > 0 and not _is_longer(c, length, k - 1, slots, mixer):
            k -= 1
    if k == 0:
        return np.int64(0)
    magnitude = _code_mantissa(c, magnitude, k, slots, mixer + LENGTHS)
    for j in range(SIGNS):
        c.state[CONTEXT + j] = slots[MAGNITUDES + MANTISSAS + j]
    negative = code_bit(c, np.int64(value < 0), mixer + LENGTHS + 1)
    return -magnitude if negative == 1 else magnitude


@inlined
def _is_longer(c: Coder, length: Int, k: Int, slots: Ints, mixer: Int) -> Flag:
    for j in range(MAGNITUDES):
        c.state[CONTEXT + j] = slots[j] + k
    return code_bit(c, np.int64(length > k), mixer + k) == 1


@inlined
def _code_mantissa(c: Coder, magnitude: Int, length: Int, slots: Ints, mixer: Int) -> Int:
    """Code the bits of a magnitude below its highest, the first three in their contexts."""
    result = np.int64(1)
    modelled = min(length - 1, 3)
    for j in range(modelled):
        node = 8 * length + result
        c.state[CONTEXT] = slots[MAGNITUDES] + node
        c.state[CONTEXT + 1] = slots[MAGNITUDES + 1] + node
        result = 2 * result + code_bit(c, (magnitude >> (length - 2 - j)) & 1, mixer)
    rest = length - 1 - modelled
    return (result << rest) | code_raw(c, magnitude & ((1 << rest) - 1), rest)
