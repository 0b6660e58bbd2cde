"""Valences, joins and the ends of joins that the region grower codes, and their contexts.

Contexts are numbers that encoder and decoder both know: valences of visited vertices around the
gate, free edges along the front, the valences coded last.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from deltamesh._kernels.coding.coder import (
    CONTEXT,
    COUNT_BITS,
    DECODING,
    PROBABILITY_BITS,
    Coder,
    code_bit,
    code_number,
    code_raw,
)
from deltamesh._kernels.coding.front import LIVE, Front
from deltamesh._kernels.coding.models import Model, layout
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Ints

# A valence is coded along a tree: is it 6; is it less; is it 5, 4, 3; is it 7, 8, ... 18.
# Above that come the bits of v - 18. Part of the format, as is all below.
NODE_SIX, NODE_LESS, NODE_BELOW, NODE_ABOVE = 0, 1, 2, 5
UNARY_END = 18
TREE = 18

# The trees of one context after the other: nothing; the valences at the pivot and its successor;
# free edges at the pivot, its successor, its predecessor; the valences at the successor and behind
# the gate; the two coded last; the valences of two known neighbours (the predecessor of the pivot
# and the successor, if the new vertex closes the pivot; else the successor and the one coded last);
# three valences of the visited face; the sum of four valences around.
VALENCE_INPUTS = 8
_, PAIR, FREE, BEHIND, LAST_TWO, NEAR_PAIR, FACE, TOTAL, CONTEXTS = layout(
    (1,), (16, 16), (8, 8, 8), (16, 16), (16, 16), (2, 16, 16), (2, 512), (32, 2)
)
VALENCE_CAP = 15

# First probabilities of the nodes of the tree: their shares in the valences of irregular meshes.
_SHARES = (0.35, 0.55, 0.68, 0.8, 0.95, 0.62, *(0.55,) * 11, 0.5)
_JOIN_SHARE = 0.01

# Indices into the model's state: the two valences coded last; the tree of each context.
RECENT, TREES = 0, 2
MODEL_SIZE = TREES + VALENCE_INPUTS

# Slots: the trees, then those of everything rarer.
JOIN_CONTEXT = 64
OF_VALENCE, OF_LOOP, OF_SIDE = 0, 1, 2
NUMBER_SLOTS = 48
_, JOIN_FLAG, LOOP_FLAG, NEAR_FLAG, NEAR_TREE, SIDE_TREE, NUMBER, SLOTS = layout(
    (CONTEXTS, TREE), (3, JOIN_CONTEXT), (1,), (1,), (64,), (64,), (3, NUMBER_SLOTS)
)

# Mixers: one for each node of the tree, twice; then those of the rarer bits. A join is too rare to
# forget one.
RARE = 2 * TREE
LENGTH, JOIN, LOOP, NEAR_BY, TARGET, SIDE = range(6)
MIXERS = (
    *((VALENCE_INPUTS, 500),) * RARE,
    *((1, 255), (3, 1000), (1, 1000), (1, 255), (1, 255), (1, 255)),
)
MODEL = Model(SLOTS, MIXERS)
NEAR_BITS = 5
NEAR = 1 << (NEAR_BITS - 1)  # a join is addressed along the front that far, then among all nodes
MAX_BITS = 40  # of a number: counts are below 2^40


def _slot(share: float, count: int) -> int:
    """Return a slot that expects a one with that probability, as if it had seen `count` bits."""
    return (int(share * (1 << PROBABILITY_BITS)) << COUNT_BITS) | count


# The first slots as they begin; small meshes gain 2 %.
PRIOR = np.array(
    [_slot(share, 1) for share in _SHARES] * CONTEXTS
    + [_slot(_JOIN_SHARE, 2)] * (3 * JOIN_CONTEXT),
    dtype=np.int64,
)


@kernel
def code_count(c: Coder, value: Int, kind: Int) -> Int:
    """Code a number >= 1 of one of the rarer kinds."""
    return code_number(c, value, NUMBER + kind * NUMBER_SLOTS, RARE + LENGTH, np.int64(MAX_BITS))


@kernel
def code_below(c: Coder, value: Int, bound: Int) -> Int:
    """Code a number in [0, bound), all equally likely, in the fewest bits or one more."""
    bits = 0
    while bound >> (bits + 1) > 0:
        bits += 1
    short = (2 << bits) - bound  # so many numbers have only `bits` bits
    shifted = value if value < short else value + short
    if c.state[DECODING] == 1:
        result = code_raw(c, value, bits)
        return result if result < short else 2 * result + code_raw(c, value, np.int64(1)) - short
    code_raw(c, shifted, bits if value < short else bits + 1)
    return value


@kernel
def _ask(c: Coder, model: Ints, node: Int, mixer: Int, answer: Flag) -> Flag:
    for i in range(VALENCE_INPUTS):
        c.state[CONTEXT + i] = model[TREES + i] + node
    return code_bit(c, 1 if answer else 0, mixer + node) == 1


@kernel
def code_valence(c: Coder, valence: Int, model: Ints, mixer: Int) -> Int:
    """Code a valence >= 2 with one tree for each context."""
    node = np.int64(NODE_SIX)
    if _ask(c, model, node, mixer, valence == 6):
        return 6
    node = np.int64(NODE_LESS)
    if _ask(c, model, node, mixer, valence < 6):
        for k in range(3):
            if _ask(c, model, NODE_BELOW + k, mixer, valence == 5 - k):
                return 5 - k
        return 2
    for k in range(7, UNARY_END + 1):
        if _ask(c, model, NODE_ABOVE + k - 7, mixer, valence == k):
            return k
    return UNARY_END + code_count(c, valence - UNARY_END, np.int64(OF_VALENCE))


@inlined
def seed_contexts(model: Ints) -> Int:
    """Set the contexts of the vertices of a first face: none is known; return the mixer."""
    for i in range(VALENCE_INPUTS):
        model[TREES + i] = 0
    return np.int64(0)


@inlined
def gate_contexts(front: Front, pivot: Int, vertices: Any, model: Ints) -> Int:
    """Set the contexts of a vertex that is new at the gate of a pivot; return the mixer."""
    nodes = front.nodes
    after, before = nodes[pivot].successor, nodes[pivot].predecessor
    at_pivot = min(vertices[nodes[pivot].vertex].valence, VALENCE_CAP)
    at_after = min(vertices[nodes[after].vertex].valence, VALENCE_CAP)
    at_before = min(vertices[nodes[before].vertex].valence, VALENCE_CAP)
    behind = min(vertices[nodes[pivot].behind].valence, VALENCE_CAP)
    free = min(nodes[pivot].free, 7)
    free_after, free_before = min(nodes[after].free, 7), min(nodes[before].free, 7)
    closes = 1 if free == 1 else 0  # the new vertex will be a neighbour of `before`, too
    pair = at_before * 16 + at_after if closes else 256 + at_after * 16 + model[RECENT]
    face = _three_bits(at_after) * 64 + _three_bits(at_pivot) * 8 + _three_bits(behind)
    total = min(max(at_pivot + at_after + at_before + behind - 16, 0), 31)
    model[TREES] = 0
    model[TREES + 1] = TREE * (PAIR + at_pivot * 16 + at_after)
    model[TREES + 2] = TREE * (FREE + free * 64 + free_after * 8 + free_before)
    model[TREES + 3] = TREE * (BEHIND + at_after * 16 + behind)
    model[TREES + 4] = TREE * (LAST_TWO + model[RECENT] * 16 + model[RECENT + 1])
    model[TREES + 5] = TREE * (NEAR_PAIR + pair)
    model[TREES + 6] = TREE * (FACE + face + 512 * closes)
    model[TREES + 7] = TREE * (TOTAL + 2 * total + closes)
    return TREE * closes


@inlined
def _three_bits(valence: Int) -> Int:
    return min(max(valence - 3, 0), 7)


@inlined
def code_join_flag(c: Coder, front: Front, pivot: Int, is_join: Flag) -> Flag:
    """Code whether the vertex at the gate is on a front already."""
    nodes = front.nodes
    state = c.state
    a1, b1 = nodes[pivot].successor, nodes[pivot].predecessor
    a2, b2 = nodes[a1].successor, nodes[b1].predecessor
    a3, b3 = nodes[a2].successor, nodes[b2].predecessor
    ahead = _two_bits(front, a1) * 16 + _two_bits(front, a2) * 4
    back = _two_bits(front, pivot) * 16 + _two_bits(front, b1) * 4
    state[CONTEXT] = JOIN_FLAG + ahead + _two_bits(front, a3)
    state[CONTEXT + 1] = JOIN_FLAG + JOIN_CONTEXT + back + _two_bits(front, b2)
    state[CONTEXT + 2] = JOIN_FLAG + 2 * JOIN_CONTEXT + ahead + _two_bits(front, b3)
    return code_bit(c, 1 if is_join else 0, RARE + JOIN) == 1


@inlined
def _two_bits(front: Front, node: Int) -> Int:
    """Return the free edges beyond the first, at most 3; on a crafted front there may be none."""
    return min(max(front.nodes[node].free - 1, 0), 3)


@inlined
def code_loop_flag(c: Coder, is_loop: Flag) -> Flag:
    """Code whether a new vertex is one that closes a boundary loop."""
    c.state[CONTEXT] = LOOP_FLAG
    return code_bit(c, 1 if is_loop else 0, RARE + LOOP) == 1


@inlined
def code_target(c: Coder, front: Front, pivot: Int, target: Int) -> Int:
    """Code the node that a join goes to; a decoder may read one that does not fit."""
    nodes = front.nodes
    state = c.state
    n1 = nodes[pivot].successor
    near = -1
    ahead, back = n1, pivot
    if state[DECODING] == 0:
        for k in range(NEAR):
            ahead, back = nodes[ahead].successor, nodes[back].predecessor
            if ahead == target or back == target:
                near = 2 * k + (0 if ahead == target else 1)
                break
    state[CONTEXT] = NEAR_FLAG
    if code_bit(c, 1 if near >= 0 else 0, RARE + NEAR_BY) == 0:
        return front.live[code_below(c, nodes[max(target, 0)].index, front.counts[LIVE])]
    near = _code_tree(c, near, np.int64(NEAR_BITS), np.int64(NEAR_TREE), RARE + TARGET)
    node = pivot if near & 1 else n1
    for _ in range((near >> 1) + 1):
        node = nodes[node].predecessor if near & 1 else nodes[node].successor
    return node


@inlined
def code_side(c: Coder, free: Int, side: Int) -> Int:
    """Code how many of the free edges of a node that splits stay on the pivot's front."""
    if free >= 8:
        return code_count(c, side + 1, np.int64(OF_SIDE)) - 1
    if free == 0:
        return 0
    return _code_tree(c, side, np.int64(3), SIDE_TREE + 8 * free, RARE + SIDE)


@kernel
def _code_tree(c: Coder, value: Int, bits: Int, slots: Int, mixer: Int) -> Int:
    """Code a number of that many bits, the high bit first, each in the context of those before."""
    node = 1
    for shift in range(bits - 1, -1, -1):
        c.state[CONTEXT] = slots + node
        node = 2 * node + code_bit(c, (value >> shift) & 1, mixer)
    return node - (1 << bits)
