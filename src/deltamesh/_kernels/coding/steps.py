"""Steps over a mesh that both sides know, which code an order of its vertices or faces.

Each step names the next vertex, or face, of the order in one of three ways: as the next one left in
coding order; as one at an *anchor*, a vertex that has its rank already, which is coded as the
distance of its rank from that of an earlier anchor; or as a number among all that are left, which
costs no more than an order without any pattern has to. The same functions encode and decode. Every
step takes one element, so that any stream ends.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.models import Model, layout
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
from deltamesh._kernels.coding.signed_integers import AXIS_MIXERS, level
from deltamesh._kernels.coding.valence import code_below
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Ints

OK, CORRUPT = 0, 1

# Kinds of steps.
NEXT, NEAR, ANY = 0, 1, 2
# Anchors: the first vertex of a face, or the oldest or newest of the vertices around.
FIRST, OLDEST, NEWEST = 0, 1, 2

# Elements of a ring that are looked at: a vertex of a thousand faces must not cost a million steps.
SCANNED = 64
CANDIDATES = 16

# Indices into the memory of a model: the kinds of the last four steps, as digits; the last trail;
# the class of the last choice at an anchor.
HISTORY, TRAIL, CHOICE = range(3)
REMEMBERED = 3

# An order may alternate between several places of the mesh: the trails, the last one first. Each
# has its last anchor and the last two distances; an anchor within reach of that belongs to it.
TRAIL_BITS = 5
TRAILS = 1 << TRAIL_BITS
ANCHOR, DISTANCE, DISTANCE_BEFORE = range(3)
REACH = 12

# A vertex without a rank counts as after all others: no difference of two ranks is as large as
# LARGEST_RANK, but that of NO_RANK and any rank is larger.
NO_RANK = 1 << 60
LARGEST_RANK = 1 << 50

# Slots and mixers: the distances, as vectors of one coordinate; then those of the kinds of steps,
# of the choice at an anchor, of the rotation of a face, of the corners skipped before a polygon.
INPUTS, TRACK_INPUTS = 3, 2
STEP_SIZE, CHOOSE_SIZE, ROTATION_SIZE, TRACK_SIZE, SKIP_SIZE = 512, 512, 256, 1024, 64
_, STEP, CHOOSE, ROTATION, TRACK, SKIP, SLOTS = layout(
    (VECTOR_SLOTS,),
    (2, INPUTS, STEP_SIZE),
    (INPUTS, CHOOSE_SIZE),
    (2, INPUTS, ROTATION_SIZE),
    (TRACK_INPUTS, TRACK_SIZE),
    (INPUTS, SKIP_SIZE),
)
STEP_MIXER, CHOOSE_MIXER, ROTATION_MIXER = AXIS_MIXERS, AXIS_MIXERS + 2, AXIS_MIXERS + 3
TRACK_MIXER = ROTATION_MIXER + 2
SKIP_MIXER = TRACK_MIXER + 1
LIMIT = 255
MIXERS = (
    *VECTOR_MIXERS[:AXIS_MIXERS],
    *((INPUTS, LIMIT),) * 5,
    (TRACK_INPUTS, LIMIT),
    (INPUTS, LIMIT),
)
MODEL = Model(SLOTS, MIXERS)


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
def trail_of(trails: Ints, anchor: Int, left: Int, margin: Int) -> Int:
    """Return the best trail to code an anchor from, -1 where a number below `left` takes less."""
    best, least = -1, _bits(left) - margin
    for k in range(TRAILS):
        cost = 3 * _bits(abs(anchor - trails[k, ANCHOR])) // 2 + (3 if k == 0 else 7)
        if cost < least:
            best, least = k, cost
    return best


@kernel
def follow(trails: Ints, anchor: Int) -> None:
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
def code_step(
    c: Coder, step: Int, memory: Ints, trails: Ints, follows: Int, has_anchor: Flag
) -> Int:
    """Code the kind of a step; `follows`, below 4, relates the next element left to the last."""
    state, history = c.state, memory[HISTORY]
    far = level(abs(trails[0, DISTANCE])) // 2
    for k in range(2 if has_anchor else 1):
        base = STEP + k * INPUTS * STEP_SIZE
        state[CONTEXT] = base + history
        state[CONTEXT + 1] = base + STEP_SIZE + 4 * (history % 9) + follows
        state[CONTEXT + 2] = base + 2 * STEP_SIZE + 16 * (history % 3) + far
        if code_bit(c, 1 if step == k else 0, STEP_MIXER + k) == 1:
            step = np.int64(k)
            break
        if k == 1 or not has_anchor:
            step = np.int64(ANY)
    memory[HISTORY] = history % 27 * 3 + step
    return step


@kernel
def code_anchor(
    c: Coder, anchor: Int, trail: Int, memory: Ints, trails: Ints, known: Ints, value: Ints
) -> Int:
    """Code the rank of an anchor: a trail, and the distance from there."""
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
    """Code an element by its number among those that are left."""
    return select(left, code_below(c, count_below(left, element) if element >= 0 else 0, count))


@inlined
def index_of(found: Ints, count: Int, element: Int) -> Int:
    """Return where an element is among the first `count` of those found, -1 if it is not."""
    for k in range(count):
        if found[k] == element:
            return k
    return -1
