"""The order of vertices and faces, as steps over a mesh that both sides know.

Each step says which vertex, or face, is next in the order of the input. Three ways to say it: the
next one left in the order of the codec; one at an *anchor*, a vertex that has its place already,
which is told by how far its place is from that of the last anchor, and then which one there; else
the rank among all that are left, which costs no more than an order without any pattern has to.
The same functions encode and decode. Every step takes one element, so that any stream ends.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.numbers import AXIS_MIXERS, level
from deltamesh._kernels.coding.remaining import Remaining, count_below, select
from deltamesh._kernels.coding.residual import (
    ABSOLUTE,
    HINT,
    KIND,
    LAST,
    NEIGHBOURS,
    SUM,
    code_vector,
)
from deltamesh._kernels.coding.residual import MIXERS as VECTOR_MIXERS
from deltamesh._kernels.coding.residual import SLOTS as VECTOR_SLOTS
from deltamesh._kernels.coding.valence import code_below
from deltamesh._kernels.jit import Flag, Int, inlined, kernel

_Ints = NDArray[np.int64]

OK, CORRUPT = 0, 1

# How a step is told.
NEXT, NEAR, ANY = 0, 1, 2
# Which vertex of a face is its anchor; of the neighbours of a vertex, the newest or the oldest.
FIRST, OLDEST, NEWEST = 0, 1, 2

# So much of a ring is looked at: a vertex of a thousand faces must not cost a million steps.
SCANNED = 64
CANDIDATES = 16

# Indices into what a model remembers: the ways of the last four steps, as digits; the last trail;
# what the last choice at an anchor looked like.
HISTORY, TRAIL, CHOICE = range(3)
REMEMBERED = 3

# An order may go on at several places of the mesh in turns: the trails, the last first. Each has
# its last anchor and the last two distances; an anchor within reach of that belongs to it.
TRAIL_BITS = 5
TRAILS = 1 << TRAIL_BITS
ANCHOR, DISTANCE, DISTANCE_BEFORE = range(3)
REACH = 12

# Slots and mixers: the distances, as vectors of one coordinate; then those of the ways, of the
# choice at an anchor, of the turn of a face, of the corners skipped where a polygon begins.
INPUTS = 3
WAY = VECTOR_SLOTS
WAY_SIZE = 512
CHOOSE = WAY + 2 * INPUTS * WAY_SIZE
CHOOSE_SIZE = 512
TURN = CHOOSE + INPUTS * CHOOSE_SIZE
TURN_SIZE = 256
TRACK = TURN + 2 * INPUTS * TURN_SIZE
TRACK_INPUTS, TRACK_SIZE = 2, 1024
SKIP = TRACK + TRACK_INPUTS * TRACK_SIZE
SKIP_SIZE = 64
SLOTS = SKIP + INPUTS * SKIP_SIZE
WAY_MIXER, CHOOSE_MIXER, TURN_MIXER = AXIS_MIXERS, AXIS_MIXERS + 2, AXIS_MIXERS + 3
TRACK_MIXER = TURN_MIXER + 2
SKIP_MIXER = TRACK_MIXER + 1
LIMIT = 255
MIXERS = (
    *VECTOR_MIXERS[:AXIS_MIXERS],
    *((INPUTS, LIMIT),) * 5,
    (TRACK_INPUTS, LIMIT),
    (INPUTS, LIMIT),
)


@inlined
def near(a: Int, b: Int) -> Int:
    """Return a - b as one of six classes: at most -2, -1, 0, 1, 2, above."""
    return min(max(a - b, -2), 3) + 2


@inlined
def _bits(x: Int) -> Int:
    n = np.int64(0)
    while x >> n > 0:
        n += 1
    return n


@kernel
def trail_of(trails: _Ints, anchor: Int, left: Int, margin: Int) -> Int:
    """Return the trail from which to tell an anchor, -1 where a rank among `left` takes less."""
    best, least = -1, _bits(left) - margin
    for k in range(TRAILS):
        cost = 3 * _bits(abs(anchor - trails[k, ANCHOR])) // 2 + (3 if k == 0 else 7)
        if cost < least:
            best, least = k, cost
    return best


@kernel
def follow(trails: _Ints, anchor: Int) -> None:
    """Bring the trail that comes by an anchor to the front; without one, the last begins anew."""
    k = 0
    while k < TRAILS - 1 and abs(anchor - trails[k, ANCHOR]) > REACH:
        k += 1
    distance, before = anchor - trails[k, ANCHOR], trails[k, DISTANCE]
    if abs(distance) > REACH:
        distance, before = np.int64(0), np.int64(0)
    while k > 0:
        trails[k] = trails[k - 1]
        k -= 1
    trails[0, ANCHOR], trails[0, DISTANCE], trails[0, DISTANCE_BEFORE] = anchor, distance, before


@kernel
def code_way(
    c: Coder, way: Int, memory: _Ints, trails: _Ints, follows: Int, has_anchor: Flag
) -> Int:
    """Code how the step is told; `follows`, below 4, is how the next one left is to the last."""
    state, history = c.state, memory[HISTORY]
    far = level(abs(trails[0, DISTANCE])) // 2
    for k in range(2 if has_anchor else 1):
        base = WAY + k * INPUTS * WAY_SIZE
        state[CONTEXT] = base + history
        state[CONTEXT + 1] = base + WAY_SIZE + 4 * (history % 9) + follows
        state[CONTEXT + 2] = base + 2 * WAY_SIZE + 16 * (history % 3) + far
        if code_bit(c, 1 if way == k else 0, WAY_MIXER + k) == 1:
            way = np.int64(k)
            break
        if k == 1 or not has_anchor:
            way = np.int64(ANY)
    memory[HISTORY] = history % 27 * 3 + way
    return way


@kernel
def code_anchor(
    c: Coder, anchor: Int, trail: Int, memory: _Ints, trails: _Ints, known: _Ints, value: _Ints
) -> Int:
    """Code the place of an anchor: a trail, and the distance from there."""
    state = c.state
    last = memory[TRAIL]
    node = np.int64(1)
    for shift in range(TRAIL_BITS - 1, -1, -1):
        state[CONTEXT] = TRACK + TRAILS * last + node
        state[CONTEXT + 1] = TRACK + TRACK_SIZE + TRAILS * (memory[HISTORY] // 3 % 9) + node
        node = 2 * node + code_bit(c, (trail >> shift) & 1, np.int64(TRACK_MIXER))
    trail = node - TRAILS
    memory[TRAIL] = trail
    first, second = trails[trail, DISTANCE], trails[trail, DISTANCE_BEFORE]
    known[:] = 0
    known[SUM] = first + second
    known[ABSOLUTE] = abs(first) + abs(second)
    known[LAST] = first
    known[HINT] = abs(second)
    known[NEIGHBOURS] = 2
    known[KIND] = min(trail, 3)
    value[0] = anchor - trails[trail, ANCHOR]
    code_vector(c, value, known)
    return trails[trail, ANCHOR] + value[0]


@inlined
def code_any(c: Coder, left: Remaining, element: Int, count: Int) -> Int:
    """Code an element by its rank among those that are left."""
    return select(left, code_below(c, count_below(left, element) if element >= 0 else 0, count))


@inlined
def index_of(found: _Ints, count: Int, element: Int) -> Int:
    """Return where an element is among the first `count` of those found, -1 if it is not."""
    for k in range(count):
        if found[k] == element:
            return k
    return -1
