"""Quantized positions, predicted by parallelograms and neighbours.

Each vertex has several predictions, the mean of all parallelograms that are known first (Touma &
Gotsman, *Triangle Mesh Compression*, Graphics Interface 1998; Cohen-Or, Cohen, Irony, *Multi-way
Geometry Encoding*, 2002), and the others for where parallelograms mislead: fans of slivers around
a hub, rows of vertices along a crease. Which one counts is settled for each axis by the errors that
all had at vertices of the same class; where Draco sends flags for the parallelograms that it leaves
out, nothing is sent. The parallelogram within a quad is better than those across its edges
(Isenburg & Alliez, *Compressing polygon mesh geometry with parallelogram prediction*, IEEE
Visualization 2002): where there is one, it is the first prediction, and the mean of all the last.
The coordinates of the vertices around are candidates (see `signed_integers`): on
machine parts most coordinates are those of a neighbour.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding import signed_integers
from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import Model
from deltamesh._kernels.coding.residual import (
    ABSOLUTE,
    HINT,
    HINT_ALL,
    KIND,
    KNOWN,
    LAST,
    MAGNITUDES,
    NEIGHBOURS,
    SIGNS,
    SUM,
    set_magnitudes,
    set_signs,
)
from deltamesh._kernels.coding.signed_integers import code_signed, level
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Ints

# Positions of a file that an encoder has written are below 2^31; extrapolation in a crafted one
# must not leave the integers.
BOUND = 1 << 40

# The predictions: the mean of the parallelograms, the gate's near end, the line from the apex
# through that, the gate's parallelogram, the mean of the known neighbours.
MEAN, NEAR, LINE, GATE, AROUND = range(5)
PREDICTIONS = 5
CANDIDATES = 3  # the ends of the gate, and the apex

# Vertices are of a class by how many parallelograms they have (or, having none, neighbours), and by
# the shape of the gate's triangle: the shorter of the two sides at its apex over the longer, in
# eighths.
SHAPES = 10
INSIDE = 4 * SHAPES + 4  # the first class of vertices that are predicted within quads
CLASSES = INSIDE + 4 * SHAPES

# Errors of a prediction are remembered over some 2^DECAY vertices of a class. Another than the mean
# of the parallelograms is taken only if it errs by less than a third as much: per axis, choices are
# noisy. Of the factors 1.25, 1.5, 2, 3 and 5, 3 makes the smallest files on the mean.
DECAY = 8
MARGIN = 3

SLOTS = signed_integers.SLOTS
MIXERS = signed_integers.mixers(MAGNITUDES + 1, SIGNS + 1, CANDIDATES)
MODEL = Model(SLOTS, MIXERS)


@kernel
def code_positions(
    c: Coder,
    indptr: Ints,
    indices: Ints,
    first: Ints,
    corners: Ints,
    within: Ints,
    values: Ints,
) -> None:
    """Code `values` (n, 3), filled in place when decoding.

    `corners[first[i]:first[i + 1]]` are the vertices (a, b, o), all below i, of the triangles
    (a, b, o) across an edge of a triangle (a, b, i); the first `within[i]` are quads (a, o, b, i)
    of the mesh. The neighbours are as `adjacency.adjacency` returns them.
    """
    n = len(values)
    residuals = np.zeros((n, 3), np.int64)
    known = np.zeros(KNOWN, np.int64)
    predictions = np.zeros((3, PREDICTIONS), np.int64)
    positions = np.zeros((3, CANDIDATES), np.int64)
    errors = np.zeros((3, CLASSES, PREDICTIONS), np.int64)
    fortunes = np.zeros((3, CANDIDATES), np.int64)
    for i in range(n):
        known[:] = 0
        _look_around(indptr, indices, residuals, i, known)
        kind = _predict(
            indptr, indices, first, corners, within, values, i, predictions, positions, known
        )
        value, residual = values[i], residuals[i]
        _code_position(c, kind, predictions, positions, known, errors, fortunes, value, residual)


@inlined
def _look_around(indptr: Ints, indices: Ints, residuals: Ints, i: Int, known: Ints) -> None:
    """Sum up the residuals of the known neighbours."""
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


@kernel
def _predict(
    indptr: Ints,
    indices: Ints,
    first: Ints,
    corners: Ints,
    within: Ints,
    values: Ints,
    i: Int,
    predictions: Ints,
    positions: Ints,
    known: Ints,
) -> Int:
    """Set the predictions, the candidates' positions and what is `known`; return the class."""
    count = first[i + 1] - first[i]
    known[KIND] = min(count, 3)
    if count == 0:
        return _predict_alone(indptr, indices, values, i, predictions, positions, known)
    inside = within[i]
    best = inside if inside > 0 else count
    gate, shape = _gate(corners, values, first[i], first[i] + best)
    a, b, o = corners[gate, 0], corners[gate, 1], corners[gate, 2]
    if _distance(values, b, o) < _distance(values, a, o):
        a, b = b, a
    spread = np.int64(0)
    for axis in range(3):
        total, low, high = np.int64(0), np.int64(4 * BOUND), np.int64(-4 * BOUND)
        some = np.int64(0)
        for at in range(first[i], first[i + 1]):
            p = values[corners[at, 0], axis] + values[corners[at, 1], axis]
            p -= values[corners[at, 2], axis]
            total += p
            if at - first[i] < best:
                some += p
            low, high = min(low, p), max(high, p)
        near, far, apex = values[a, axis], values[b, axis], values[o, axis]
        predictions[axis, MEAN] = (2 * some + best) // (2 * best)
        predictions[axis, NEAR] = near
        predictions[axis, LINE] = 2 * near - apex
        predictions[axis, GATE] = near + far - apex
        if inside > 0:
            predictions[axis, AROUND] = (2 * total + count) // (2 * count)
        else:
            predictions[axis, AROUND] = _neighbour_mean(indptr, indices, values, i, axis)
        positions[axis, 0], positions[axis, 1], positions[axis, 2] = near, far, apex
        known[HINT + axis] = high - low
        spread += high - low
    known[HINT_ALL] = level(spread) // 2
    return 4 + (min(count, 3) + (4 if inside > 0 else 0)) * SHAPES + shape


@inlined
def _predict_alone(
    indptr: Ints,
    indices: Ints,
    values: Ints,
    i: Int,
    predictions: Ints,
    positions: Ints,
    known: Ints,
) -> Int:
    """Set the same where there is no parallelogram; return the class."""
    before: Int = max(i - 1, 0)
    last: Int = before
    for at in range(indptr[i], indptr[i + 1]):
        if indices[at] < i:
            last = indices[at]
    for axis in range(3):
        previous = values[before, axis] if i > 0 else np.int64(0)
        near = values[last, axis] if i > 0 else np.int64(0)
        mean = previous
        if known[NEIGHBOURS] > 0:
            mean = _neighbour_mean(indptr, indices, values, i, axis)
        else:
            near = previous
        predictions[axis, :] = mean
        predictions[axis, NEAR] = near
        predictions[axis, LINE] = previous
        positions[axis, 0], positions[axis, 1], positions[axis, 2] = near, previous, mean
    return min(known[NEIGHBOURS], 3)


@inlined
def _gate(corners: Ints, values: Ints, first: Int, end: Int) -> tuple[Int, Int]:
    """Return the parallelogram whose triangle has the most equal sides at its apex, and these."""
    gate: Int = first
    best: Int = np.int64(-1)
    for at in range(first, end):
        o = corners[at, 2]
        one, other = _distance(values, corners[at, 0], o), _distance(values, corners[at, 1], o)
        shape = 8 * min(one, other) // max(one, other, 1)
        if shape > best:
            gate, best = at, shape
    return gate, best


@inlined
def _distance(values: Ints, i: Int, j: Int) -> Int:
    """Return the sum of the distances along the axes."""
    total = np.int64(0)
    for axis in range(3):
        total += abs(values[i, axis] - values[j, axis])
    return total


@inlined
def _neighbour_mean(indptr: Ints, indices: Ints, values: Ints, i: Int, axis: Int) -> Int:
    """Return the mean of the known neighbours; 0 without any, as within a polygon."""
    total, count = np.int64(0), np.int64(0)
    for at in range(indptr[i], indptr[i + 1]):
        if indices[at] < i:
            total += values[indices[at], axis]
            count += 1
    return total // count if count > 0 else np.int64(0)


@kernel
def _code_position(
    c: Coder,
    kind: Int,
    predictions: Ints,
    positions: Ints,
    known: Ints,
    errors: Ints,
    fortunes: Ints,
    value: Ints,
    residual: Ints,
) -> None:
    """Code one position and learn from it."""
    magnitudes, signs = np.empty(MAGNITUDES + 1, np.int64), np.empty(SIGNS + 1, np.int64)
    candidates, histories = np.empty(CANDIDATES, np.int64), np.empty(CANDIDATES, np.int64)
    total = known[ABSOLUTE] + known[ABSOLUTE + 1] + known[ABSOLUTE + 2]
    spent, along = np.int64(0), np.int64(0)
    for axis in range(3):
        chosen = _chosen(errors[axis, kind], kind >= INSIDE)
        base = predictions[axis, chosen]
        off = predictions[axis, NEAR] - base
        set_magnitudes(magnitudes, known, axis, total, spent)
        step = level(abs(predictions[axis, MEAN] - predictions[axis, NEAR])) // 2
        magnitudes[MAGNITUDES] = (kind * PREDICTIONS + chosen) * 8 + min(step, 7)
        set_signs(signs, known, axis, along)
        signs[SIGNS] = 1 if off > 0 else (2 if off < 0 else 0)
        for k in range(CANDIDATES):
            candidates[k] = positions[axis, k] - base
            histories[k] = 2 * fortunes[axis, k] + (1 if candidates[k] == 0 else 0)
        r = value[axis] - base
        r = code_signed(c, r, np.int64(axis), magnitudes, signs, candidates, histories)
        residual[axis] = r
        value[axis] = min(max(base + r, -BOUND), BOUND)
        for k in range(CANDIDATES):
            fortunes[axis, k] = (2 * fortunes[axis, k] + (1 if r == candidates[k] else 0)) & 15
        for k in range(PREDICTIONS):
            error = errors[axis, kind, k]
            error += 16 * abs(base + r - predictions[axis, k]) - (error >> DECAY)
            errors[axis, kind, k] = error
        spent += abs(r)
        along += known[SUM + axis] * r


@inlined
def _chosen(errors: Ints, inside: Flag) -> Int:
    """Return the prediction with the least error."""
    chosen = np.int64(0)
    for k in range(1, PREDICTIONS):
        margin = MARGIN if chosen == MEAN and not (inside and k == AROUND) else 1
        if errors[k] * margin < errors[chosen]:
            chosen = np.int64(k)
    return chosen
