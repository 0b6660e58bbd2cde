"""Wedges, classes of corners at a point: split vertices, or the two sides of a seam.

The corners of a point are visited fan by fan in their rotational order. A corner is in the wedge of
the one before unless a seam runs between them, along the edge that they share; a seam at one end of
an edge mostly goes on at the other.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.models import Model, layout
from deltamesh._kernels.coding.valence import code_below
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge
from deltamesh_formats.array_types import Ints

# The kind of a corner, by its relation to the one that it is expected to be like: across an edge,
# the first of a further fan, in a repeat of a face, in a degenerate face.
ACROSS, FAN, REPEAT, DEGENERATE = range(4)
# The status of an edge at its other end: not visited, no seam, a seam, no edge.
UNKNOWN, SMOOTH, SEAM, OPEN = range(4)

SAME, NEW, MORE = range(3)
MIXERS = ((5, 255), (2, 255), (2, 255))
# The first slot of each input of the mixers: its range is indexed by its contexts.
(
    SAME_BY_KIND,
    SAME_BY_SEAMS,
    SAME_BY_UNKNOWN,
    SAME_BY_DISTANCE,
    SAME_BY_COUNT,
    NEW_BY_KIND,
    NEW_BY_COUNT,
    MORE_BY_LAST,
    MORE_BY_NUMBER,
    SLOTS,
) = layout(
    (4, 4, 4),
    (4, 4, 4, 4),
    (4, 4, 4, 4),
    (4, 8, 8),
    (4, 4, 4, 2, 2),
    (4, 4, 4),
    (16, 4),
    (4, 4),
    (16,),
)
MODEL = Model(SLOTS, MIXERS)


@kernel
def fill_rings(
    opposite: Ints,
    corners: Ints,
    by_point: Ints,
    ring: Ints,
    spoke: Ints,
    closing: Ints,
) -> None:
    """Put the corners of each point into rotational order, fan by fan.

    opposite : int64 (3 m,), of a manifold; corners : int64 (3 m,), its vertices.
    by_point : int64 (n,), the vertices in the order of their points.
    ring : int64 (3 m,), the corners; spoke : the half-edge that leads on to each from the corner
        before, -1 at the first of a fan; closing : that from the last of a closed fan to the first.
    """
    first = np.full(len(by_point), -1, np.int64)
    for h in range(len(corners)):
        v = corners[h]
        if first[v] < 0 or opposite[previous_halfedge(h)] < 0:
            first[v] = h
    at = 0
    for k in range(len(by_point)):
        start = first[by_point[k]]
        closed = opposite[previous_halfedge(start)]
        h, g = start, np.int64(-1)
        while True:
            ring[at], spoke[at], closing[at] = h, g, closed
            at += 1
            g = h
            if opposite[h] < 0:
                break
            h = next_halfedge(opposite[h])
            if h == start:
                break


@inlined
def _status(seams: Ints, opposite: Ints, h: Int) -> Int:
    return seams[opposite[h]] if h >= 0 and opposite[h] >= 0 else np.int64(OPEN)


@inlined
def _look_ahead(
    seams: Ints,
    opposite: Ints,
    first: Int,
    end: Int,
    spoke: Ints,
    closing: Ints,
    ahead: Ints,
    left: Ints,
) -> Int:
    """Return how many seams are known that run into a point.

    For each corner, set how many corners further the next of them is (0: none before the end) and
    how many edges from there on nothing is known of.
    """
    seen, unknown, distance = 0, 0, 0
    for i in range(end - 1, first - 1, -1):
        far = _status(seams, opposite, spoke[i])
        if spoke[i] < 0 and closing[i] >= 0:
            seen += _status(seams, opposite, closing[i]) == SEAM
        seen += far == SEAM
        unknown += far == UNKNOWN
        ahead[i], left[i] = distance, unknown
        if far == SEAM:
            distance = 1
        elif distance > 0:
            distance += 1
    return seen


@kernel
def code_wedges(
    c: Coder,
    opposite: Ints,
    bounds: Ints,
    ring: Ints,
    spoke: Ints,
    closing: Ints,
    like: Ints,
    kind: Ints,
    wedges: Ints,
    labels: Int,
) -> Int:
    """Code the wedges of corners; return how many there are, over all points.

    bounds : int64 (p + 1,), where the corners of each point begin in `ring`, `spoke`, `closing`,
        `like` (the corner that each is expected to be like, -1 for the first of a point), `kind`.
    wedges : int64, of each corner: any numbers below `labels` when encoding, which are compared at
        one point only. Replaced by numbers that ascend with the points and the visits.
    labels : 0 when decoding.
    """
    state = c.state
    seams = np.full(len(opposite), UNKNOWN, np.int64)
    met = np.full(labels, -1, np.int64)  # the last point that had each label, and which it is there
    number = np.zeros(labels, np.int64)
    ahead, left = np.empty(len(ring), np.int64), np.empty(len(ring), np.int64)
    base, recent, several = np.int64(0), 0, 0
    for p in range(len(bounds) - 1):
        first, end = bounds[p], bounds[p + 1]
        seen = min(_look_ahead(seams, opposite, first, end, spoke, closing, ahead, left), 3)
        start: Int = np.int64(0)
        count, changes, behind = np.int64(0), 0, 0
        for i in range(first, end):
            corner = ring[i]
            actual = np.int64(0)
            if labels > 0:
                label = wedges[corner]
                if met[label] != p:
                    met[label], number[label] = p, count
                actual = number[label]
            if like[i] >= 0:
                expected = wedges[like[i]] - base
                far = _status(seams, opposite, spoke[i])
                back = _status(seams, opposite, closing[i])
                known = kind[i] * 16 + min(count, 4) - 1
                found = 64 * far + 16 * seen + 4 * min(changes, 3)
                state[CONTEXT] = SAME_BY_KIND + (kind[i] * 4 + far) * 4 + recent
                state[CONTEXT + 1] = SAME_BY_SEAMS + found + kind[i]
                state[CONTEXT + 2] = SAME_BY_UNKNOWN + found + min(left[i], 3)
                distance = 64 * far + 8 * min(behind, 7) + min(ahead[i], 7)
                state[CONTEXT + 3] = SAME_BY_DISTANCE + distance
                state[CONTEXT + 4] = SAME_BY_COUNT + 4 * known + 2 * several + (back == SEAM)
                same = code_bit(c, 1 if actual == expected else 0, np.int64(SAME))
                recent = 2 * (recent & 1) + same
                behind += behind > 0
                if same == 1:
                    actual = expected
                else:
                    actual = _code_other(c, actual, expected, count, known + 4 * back, far)
                    changes += 1
                    behind = 1
                if spoke[i] >= 0:
                    seams[spoke[i]] = SMOOTH if same == 1 else SEAM
            if spoke[i] < 0:
                start = actual
            if closing[i] >= 0:
                seams[closing[i]] = SMOOTH if start == actual else SEAM
            count = max(count, actual + 1)
            wedges[corner] = base + actual
        several = 1 if count > 1 else 0
        base += count
    return base


@inlined
def _code_other(c: Coder, actual: Int, expected: Int, count: Int, known: Int, far: Int) -> Int:
    """Code a wedge that is not the expected one: a new one, or one of the others."""
    if count == 1:
        return np.int64(1)
    c.state[CONTEXT] = NEW_BY_KIND + known
    c.state[CONTEXT + 1] = NEW_BY_COUNT + 4 * min(count, 15) + far
    if code_bit(c, 1 if actual == count else 0, np.int64(NEW)) == 1:
        return count
    other = code_below(c, actual - (1 if actual > expected else 0), count - 1)
    return other + (1 if other >= expected else 0)


@kernel
def code_isolated(c: Coder, isolated: Ints, total: Int) -> Flag:
    """Code the number of isolated vertices at each point; return whether the sum is the total.

    isolated : int64 (p,), filled in when decoding.
    """
    rest = total
    last = 0
    for p in range(len(isolated)):
        number, k = isolated[p], 0
        while rest > 0:
            c.state[CONTEXT] = MORE_BY_LAST + min(k, 3) * 4 + min(last, 3)
            c.state[CONTEXT + 1] = MORE_BY_NUMBER + min(k, 15)
            if code_bit(c, 1 if number > k else 0, np.int64(MORE)) == 0:
                break
            k += 1
            rest -= 1
        isolated[p] = last = k
    return rest == 0
