"""At which corner a polygon begins: at one of its triangle, or some corners after that.

The corner of the triangle is told from one that the places of its vertices single out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.steps import (
    FIRST,
    INPUTS,
    NEWEST,
    OLDEST,
    SKIP,
    SKIP_MIXER,
    SKIP_SIZE,
    TURN,
    TURN_MIXER,
    TURN_SIZE,
)
from deltamesh._kernels.jit import Int, inlined, kernel

_Ints = NDArray[np.int64]


@inlined
def place_of(places: _Ints, v: Int) -> Int:
    """Return the place of a vertex; without one, it is after all that have one."""
    return places[v] if places[v] >= 0 else np.int64(1) << 60


@inlined
def anchor_corner(faces: _Ints, places: _Ints, mode: Int, face: Int, turn: Int) -> Int:
    """Return the corner of a face that is its anchor, the first of equals."""
    if mode == FIRST:
        return np.int64(turn)
    best = np.int64(0)
    for j in range(1, 3):
        new, old = places[faces[face, j]], places[faces[face, best]]
        better = new > old if mode == NEWEST else new >= 0 and (old < 0 or new < old)
        if better:
            best = np.int64(j)
    return best


@inlined
def _among(recent: _Ints, v: Int) -> Int:
    """Return where a vertex is among those of the face before, 3 if it is not."""
    for k in range(3):
        if recent[0, k] == v:
            return np.int64(k)
    return np.int64(3)


@inlined
def _rising(places: _Ints, v: Int, w: Int) -> Int:
    """Return 0 if the place of v is below that of w, 1 if above, 2 if both have none, or one."""
    b, d = place_of(places, v), place_of(places, w)
    return 0 if b < d else (1 if d < b else 2)


@kernel
def code_skipped(
    c: Coder,
    corners: _Ints,
    first: Int,
    size: Int,
    places: _Ints,
    recent: _Ints,
    skips: _Ints,
    at: Int,
    gap: Int,
    skipped: Int,
) -> Int:
    """Code how many corners, below `gap`, after a corner of its triangle a polygon begins.

    corners[first : first + size] are the vertices of the polygon; at : that corner.
    skips : int64 (1,), the last answers.
    """
    state = c.state
    for k in range(gap - 1):
        v, w = corners[first + (at + k) % size], corners[first + (at + k + 1) % size]
        rising = _rising(places, v, w)
        state[CONTEXT] = SKIP + 12 * _among(recent, v) + 3 * _among(recent, w) + rising
        state[CONTEXT + 1] = SKIP + SKIP_SIZE + skips[0]
        state[CONTEXT + 2] = SKIP + 2 * SKIP_SIZE + 12 * min(k, 3) + 4 * rising + skips[0] % 4
        bit = code_bit(c, 1 if skipped > k else 0, np.int64(SKIP_MIXER))
        skips[0] = (2 * skips[0] + bit) & 15
        if bit == 0:
            return np.int64(k)
    return np.int64(gap - 1)


@kernel
def code_turn(
    c: Coder,
    faces: _Ints,
    places: _Ints,
    mode: Int,
    recent: _Ints,
    turned: _Ints,
    face: Int,
    turn: Int,
) -> Int:
    """Code at which corner a face begins, from a corner that its vertices single out."""
    state = c.state
    base = anchor_corner(faces, places, OLDEST if mode == FIRST else mode, face, np.int64(0))
    mask, pattern = 0, 0
    for j in range(3):
        v = faces[face, (base + j) % 3]
        where = _among(recent, v)
        mask = 2 * mask + (1 if where < 3 else 0)
        pattern = 4 * pattern + where
    rising = _rising(places, faces[face, (base + 1) % 3], faces[face, (base + 2) % 3])
    straight = (3 - base) % 3
    result = (turn - base) % 3
    for k in range(2):
        at = TURN + k * INPUTS * TURN_SIZE
        state[CONTEXT] = at + 3 * pattern + turned[0]
        state[CONTEXT + 1] = at + TURN_SIZE + 24 * turned[0] + 3 * mask + rising
        state[CONTEXT + 2] = at + 2 * TURN_SIZE + 3 * turned[1] + straight
        if code_bit(c, 1 if result == k else 0, TURN_MIXER + k) == 1:
            result = np.int64(k)
            break
        if k == 1:
            result = np.int64(2)
    turned[0] = result
    turned[1] = turned[1] % 2 * 2 + (1 if result == straight else 0)
    return (base + result) % 3
