"""Quantized positions, predicted by all the parallelograms that are known.

Touma & Gotsman, *Triangle Mesh Compression*, Graphics Interface 1998; several parallelograms:
Cohen-Or, Cohen, Irony, *Multi-way Geometry Encoding*, 2002. Where Draco sends a flag for each
parallelogram that it leaves out, here their disagreement is a context.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.coder import Coder
from deltamesh.kernels.jit import Int, inlined, kernel
from deltamesh.kernels.residual import (
    ABSOLUTE,
    HINT,
    HINT_ALL,
    KIND,
    KNOWN,
    LAST,
    NEIGHBOURS,
    SUM,
    code_vector,
    level,
)

_Ints = NDArray[np.int64]

# Positions of a file that an encoder has written are below 2^31; extrapolation in a crafted one
# must not leave the integers.
BOUND = 1 << 40


@kernel
def code_positions(
    c: Coder, indptr: _Ints, indices: _Ints, first: _Ints, corners: _Ints, values: _Ints
) -> None:
    """Code `values` (n, 3), filled in place when decoding.

    `corners[first[i]:first[i + 1]]` are the vertices (a, b, o), all below i, of the triangles
    (a, b, o) across an edge of a triangle (a, b, i); the neighbours are as of `adjacency`.
    """
    n = len(values)
    residuals = np.zeros((n, 3), np.int64)
    known = np.zeros(KNOWN, np.int64)
    prediction = np.zeros(3, np.int64)
    for i in range(n):
        known[:] = 0
        _predict(indptr, indices, first, corners, values, i, known, prediction)
        for at in range(indptr[i], indptr[i + 1]):
            j = indices[at]
            if j >= i:
                break  # neighbours ascend
            known[NEIGHBOURS] += 1
            for axis in range(3):
                known[SUM + axis] += residuals[j, axis]
                known[ABSOLUTE + axis] += abs(residuals[j, axis])
        for axis in range(3):
            known[LAST + axis] = residuals[i - 1, axis] if i > 0 else 0
            residuals[i, axis] = values[i, axis] - prediction[axis]
        code_vector(c, residuals[i], known)
        for axis in range(3):
            position = prediction[axis] + residuals[i, axis]
            values[i, axis] = min(max(position, -BOUND), BOUND)


@inlined
def _predict(
    indptr: _Ints,
    indices: _Ints,
    first: _Ints,
    corners: _Ints,
    values: _Ints,
    i: Int,
    known: _Ints,
    prediction: _Ints,
) -> None:
    """Set the prediction, the number of parallelograms and how far they disagree."""
    count = first[i + 1] - first[i]
    known[KIND] = min(count, 3)
    spread = np.int64(0)
    for axis in range(3):
        if count == 0:
            prediction[axis] = _neighbour_mean(indptr, indices, values, i, axis)
            continue
        total, low, high = np.int64(0), np.int64(4 * BOUND), np.int64(-4 * BOUND)
        for at in range(first[i], first[i + 1]):
            a, b, o = corners[at, 0], corners[at, 1], corners[at, 2]
            p = values[a, axis] + values[b, axis] - values[o, axis]
            total += p
            low, high = min(low, p), max(high, p)
        prediction[axis] = (2 * total + count) // (2 * count)
        known[HINT + axis] = high - low
        spread += high - low
    known[HINT_ALL] = level(spread) // 2


@inlined
def _neighbour_mean(indptr: _Ints, indices: _Ints, values: _Ints, i: Int, axis: Int) -> Int:
    """Return the mean of the known neighbours; the vertex before where there is none."""
    total, count = np.int64(0), 0
    for at in range(indptr[i], indptr[i + 1]):
        if indices[at] < i:
            total += values[indices[at], axis]
            count += 1
    if count > 0:
        return total // count
    return values[i - 1, axis] if i > 0 else np.int64(0)
