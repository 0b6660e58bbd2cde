"""Merged half-edges that are no candidates of each other, coded as explicit pairs."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.hidden_edges import (
    CHOOSE,
    CHOOSE_BY_RANK,
    CHOOSE_BY_SIZE,
    PAIR,
    PAIR_BY_CANDIDATE,
    PAIR_BY_HISTORY,
    PAIR_BY_SIZE,
    corners_class,
    join,
    root_of,
)
from deltamesh._kernels.coding.valence import code_below
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Ints

# Bounds on the work at an edge with many triangles: half-edges that are looked at, and half-edges
# that fit.
SCANNED = 64
FITTING = 16


@kernel
def code_explicit_pairs(
    c: Coder,
    candidate: Ints,
    pairs: Ints,
    merged: Ints,
    parent: Ints,
    size: Ints,
    most: Int,
    total: Int,
    order: Ints,
    group: Ints,
    across: Ints,
    bounds: Ints,
) -> Flag:
    """Code the explicit pairs; return whether their number is the total.

    pairs : int64 (3 m,), the half-edge that each is to be merged with, -1 for none; empty when
        decoding.
    candidate, merged, parent, size : see `hidden_edges.code_hidden`; the last three are updated.
    order : int64 (3 m,), half-edges by start, end and index: group i has those from bounds[i] on.
    group : int64 (3 m,), of each half-edge.
    across : of each group, the group of the half-edges that run back, -1 for none.
    """
    state = c.state
    encoding = len(pairs) > 0
    first = np.full(len(across), -1, np.int64)  # lists of half-edges not merged, ascending
    after, before = np.full((2, len(order)), -1, np.int64)
    for i in range(len(across)):
        last = np.int64(-1)
        for at in range(bounds[i], bounds[i + 1]):
            h = order[at]
            if merged[h] < 0:
                before[h] = last
                if last < 0:
                    first[i] = h
                else:
                    after[last] = h
                last = h
    found = np.empty(FITTING, np.int64)
    history = 0
    for h in range(len(order)):
        r = root_of(parent, h // 3)
        other = across[group[h]]
        if total == 0 or merged[h] >= 0 or size[r] >= most or other < 0:
            continue
        while 0 <= first[other] <= h:
            first[other] = after[first[other]]
        if first[other] < 0:
            continue
        number = _fitting(parent, size, first[other], after, r, most, found)
        x, rich = corners_class(size[r]), min(number, 3)
        state[CONTEXT] = PAIR_BY_SIZE + (4 * x + rich) * 3 + h % 3
        state[CONTEXT + 1] = PAIR_BY_HISTORY + 16 * x + history
        free = 1 if candidate[h] < 0 else 0
        state[CONTEXT + 2] = PAIR_BY_CANDIDATE + (4 * x + rich) * 2 + free
        bit = code_bit(c, 1 if encoding and pairs[h] >= 0 else 0, np.int64(PAIR))
        history = (2 * history + bit) & 15
        if bit == 0:
            continue
        g: Int = _choose(c, size, parent, h, pairs[h] if encoding else np.int64(-1), found, number)
        if g < 0:
            g = _code_any(c, pairs, order, bounds[other], bounds[other + 1], h, encoding)
            s = root_of(parent, g // 3)
            if g <= h or merged[g] >= 0 or r == s or size[r] + size[s] - 2 > most:
                return False
            for at in range(number):
                if found[at] == g:
                    return False
        _unlink(first, after, before, group, h)
        _unlink(first, after, before, group, g)
        join(merged, parent, size, h, g, r, root_of(parent, g // 3))
        total -= 1
    return total == 0


@inlined
def _fitting(parent: Ints, size: Ints, g: Int, after: Ints, r: Int, most: Int, found: Ints) -> Int:
    """Find the half-edges in a list from g on that polygon r may merge with; return how many."""
    number = 0
    for _ in range(SCANNED):
        if g < 0 or number == FITTING:
            break
        s = root_of(parent, g // 3)
        if r != s and size[r] + size[s] - 2 <= most:
            found[number] = g
            number += 1
        g = after[g]
    return number


@inlined
def _choose(
    c: Coder, size: Ints, parent: Ints, h: Int, actual: Int, found: Ints, number: Int
) -> Int:
    """Code which of the half-edges found is meant, one bit for each; -1 for none."""
    for i in range(number):
        y = corners_class(size[root_of(parent, found[i] // 3)])
        c.state[CONTEXT] = CHOOSE_BY_RANK + 4 * min(i, 7) + min(number - 1 - i, 3)
        c.state[CONTEXT + 1] = CHOOSE_BY_SIZE + 9 * y + 3 * (h % 3) + found[i] % 3
        if code_bit(c, 1 if found[i] == actual else 0, np.int64(CHOOSE)) == 1:
            return found[i]
    return np.int64(-1)


@inlined
def _code_any(
    c: Coder, pairs: Ints, order: Ints, first: Int, end: Int, h: Int, encoding: Flag
) -> Int:
    """Code a half-edge of a group by its rank."""
    rank: Int = np.int64(0)
    if encoding:
        rank = np.searchsorted(order[first:end], pairs[h])
    return order[first + code_below(c, rank, end - first)]


@inlined
def _unlink(first: Ints, after: Ints, before: Ints, group: Ints, h: Int) -> None:
    """Take a half-edge out of its list, unless the list begins beyond it already."""
    if first[group[h]] == h:
        first[group[h]] = after[h]
    if before[h] >= 0:
        after[before[h]] = after[h]
    if after[h] >= 0:
        before[after[h]] = before[h]
