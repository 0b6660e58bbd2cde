"""Rotation of a polygon: the corner at which it begins.

It is a corner of the triangle that represents the polygon, coded relative to one that the ranks of
its vertices single out, or some corners after that.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.steps import (
    FIRST,
    INPUTS,
    NEWEST,
    NO_RANK,
    OLDEST,
    ROTATION,
    ROTATION_MIXER,
    ROTATION_SIZE,
    SKIP,
    SKIP_MIXER,
    SKIP_SIZE,
)
from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Ints


@inlined
def rank_of(rank: Ints, v: Int) -> Int:
    """Return the rank of a vertex, `NO_RANK` without one."""
    return rank[v] if rank[v] >= 0 else np.int64(NO_RANK)


@inlined
def anchor_corner(faces: Ints, rank: Ints, mode: Int, face: Int, rotation: Int) -> Int:
    """Return the corner of a face that is its anchor, the first of equals."""
    if mode == FIRST:
        return np.int64(rotation)
    best = np.int64(0)
    for j in range(1, 3):
        new, old = rank[faces[face, j]], rank[faces[face, best]]
        better = new > old if mode == NEWEST else new >= 0 and (old < 0 or new < old)
        if better:
            best = np.int64(j)
    return best


@inlined
def _among(recent: Ints, v: Int) -> Int:
    """Return the corner of the face before that has a vertex, 3 if none has."""
    for k in range(3):
        if recent[0, k] == v:
            return np.int64(k)
    return np.int64(3)


@inlined
def _rising(rank: Ints, v: Int, w: Int) -> Int:
    """Return 0 if the rank of v is below that of w, 1 if above, 2 if they are equal."""
    b, d = rank_of(rank, v), rank_of(rank, w)
    return 0 if b < d else (1 if d < b else 2)


@kernel
def code_skipped(
    c: Coder,
    corners: Ints,
    first: Int,
    size: Int,
    rank: Ints,
    recent: Ints,
    skips: Ints,
    at: Int,
    gap: Int,
    skipped: Int,
) -> Int:
    """Code the number of corners, below `gap`, from one of its triangle to the first of a polygon.

    corners[first : first + size] are the vertices of the polygon; at : that corner.
    skips : int64 (1,), the last answers.
    """
    state = c.state
    for k in range(gap - 1):
        v, w = corners[first + (at + k) % size], corners[first + (at + k + 1) % size]
        rising = _rising(rank, v, w)
        state[CONTEXT] = SKIP + 12 * _among(recent, v) + 3 * _among(recent, w) + rising
        state[CONTEXT + 1] = SKIP + SKIP_SIZE + skips[0]
        state[CONTEXT + 2] = SKIP + 2 * SKIP_SIZE + 12 * min(k, 3) + 4 * rising + skips[0] % 4
        bit = code_bit(c, 1 if skipped > k else 0, np.int64(SKIP_MIXER))
        skips[0] = (2 * skips[0] + bit) & 15
        if bit == 0:
            return np.int64(k)
    return np.int64(gap - 1)


@kernel
def code_rotation(
    c: Coder,
    faces: Ints,
    rank: Ints,
    mode: Int,
    recent: Ints,
    rotated: Ints,
    face: Int,
    rotation: Int,
) -> Int:
    """Code the rotation of a face, relative to the corner that its vertices single out."""
    state = c.state
    base = anchor_corner(faces, rank, OLDEST if mode == FIRST else mode, face, np.int64(0))
    mask, pattern = 0, 0
    for j in range(3):
        v = faces[face, (base + j) % 3]
        where = _among(recent, v)
        mask = 2 * mask + (1 if where < 3 else 0)
        pattern = 4 * pattern + where
    rising = _rising(rank, faces[face, (base + 1) % 3], faces[face, (base + 2) % 3])
    straight = (3 - base) % 3
    result = (rotation - base) % 3
    for k in range(2):
        at = ROTATION + k * INPUTS * ROTATION_SIZE
        state[CONTEXT] = at + 3 * pattern + rotated[0]
        state[CONTEXT + 1] = at + ROTATION_SIZE + 24 * rotated[0] + 3 * mask + rising
        state[CONTEXT + 2] = at + 2 * ROTATION_SIZE + 3 * rotated[1] + straight
        if code_bit(c, 1 if result == k else 0, ROTATION_MIXER + k) == 1:
            result = np.int64(k)
            break
        if k == 1:
            result = np.int64(2)
    rotated[0] = result
    rotated[1] = rotated[1] % 2 * 2 + (1 if result == straight else 0)
    return (base + result) % 3
