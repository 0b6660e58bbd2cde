"""At which corner a face begins, told from a corner that the places of its vertices single out."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.coder import CONTEXT, Coder, code_bit
from deltamesh.kernels.jit import Int, inlined, kernel
from deltamesh.kernels.steps import FIRST, INPUTS, NEWEST, OLDEST, TURN, TURN_MIXER, TURN_SIZE

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
        where = 3
        for k in range(3):
            if recent[0, k] == v:
                where = min(where, k)
        mask = 2 * mask + (1 if where < 3 else 0)
        pattern = 4 * pattern + where
    b, d = (
        place_of(places, faces[face, (base + 1) % 3]),
        place_of(places, faces[face, (base + 2) % 3]),
    )
    rising = 0 if b < d else (1 if d < b else 2)
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
