"""Which half-edges are glued that are no partners: the few that `polygons` cannot tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.hidden_edges import (
    CHOOSE,
    CHOOSE_AT,
    LIST,
    LIST_AT,
    corners_class,
    join,
    root_of,
)
from deltamesh._kernels.coding.valence import code_below
from deltamesh._kernels.jit import Flag, Int, inlined, kernel

_Ints = NDArray[np.int64]

# Of an edge with many triangles, so many half-edges are looked at, and so many that fit taken.
SCANNED = 64
CANDIDATES = 16


@kernel
def code_listed(
    c: Coder,
    partner: _Ints,
    wanted: _Ints,
    glued: _Ints,
    parent: _Ints,
    size: _Ints,
    most: Int,
    total: Int,
    order: _Ints,
    group: _Ints,
    across: _Ints,
    bounds: _Ints,
) -> Flag:
    """Code what else is glued; return whether it comes to the total.

    wanted : int64 (3 m,), the half-edge that each is to be glued to, -1 for none; when encoding.
    glued, parent, size : see `polygons.code_hidden`; filled in.
    order : int64 (3 m,), half-edges by start, end and index: group i has those from bounds[i] on.
    group : int64 (3 m,), of each half-edge.
    across : of each group, that of the opposite way, -1 for none.
    """
    k = c.state
    encoding = len(wanted) > 0
    first = np.full(len(across), -1, np.int64)  # lists of what is not glued, ascending
    after, before = np.full((2, len(order)), -1, np.int64)
    for i in range(len(across)):
        last = np.int64(-1)
        for at in range(bounds[i], bounds[i + 1]):
            h = order[at]
            if glued[h] < 0:
                before[h] = last
                if last < 0:
                    first[i] = h
                else:
                    after[last] = h
                last = h
    found = np.empty(CANDIDATES, np.int64)
    history = 0
    for h in range(len(order)):
        r = root_of(parent, h // 3)
        other = across[group[h]]
        if total == 0 or glued[h] >= 0 or size[r] >= most or other < 0:
            continue
        while 0 <= first[other] <= h:
            first[other] = after[first[other]]
        if first[other] < 0:
            continue
        number = _fitting(parent, size, first[other], after, r, most, found)
        x, rich = corners_class(size[r]), min(number, 3)
        k[CONTEXT] = LIST_AT + (4 * x + rich) * 3 + h % 3
        k[CONTEXT + 1] = LIST_AT + 64 + 16 * x + history
        k[CONTEXT + 2] = LIST_AT + 128 + (4 * x + rich) * 2 + (1 if partner[h] < 0 else 0)
        bit = code_bit(c, 1 if encoding and wanted[h] >= 0 else 0, np.int64(LIST))
        history = (2 * history + bit) & 15
        if bit == 0:
            continue
        g: Int = _choose(c, size, parent, h, wanted[h] if encoding else np.int64(-1), found, number)
        if g < 0:
            g = _code_any(c, wanted, order, bounds[other], bounds[other + 1], h, encoding)
            s = root_of(parent, g // 3)
            if g <= h or glued[g] >= 0 or r == s or size[r] + size[s] - 2 > most:
                return False
            for at in range(number):
                if found[at] == g:
                    return False
        _unlink(first, after, before, group, h)
        _unlink(first, after, before, group, g)
        join(glued, parent, size, h, g, r, root_of(parent, g // 3))
        total -= 1
    return total == 0


@inlined
def _fitting(
    parent: _Ints, size: _Ints, g: Int, after: _Ints, r: Int, most: Int, found: _Ints
) -> Int:
    """Find what polygon r could be glued to in a list from g on; return how many."""
    number = 0
    for _ in range(SCANNED):
        if g < 0 or number == CANDIDATES:
            break
        s = root_of(parent, g // 3)
        if r != s and size[r] + size[s] - 2 <= most:
            found[number] = g
            number += 1
        g = after[g]
    return number


@inlined
def _choose(
    c: Coder, size: _Ints, parent: _Ints, h: Int, wanted: Int, found: _Ints, number: Int
) -> Int:
    """Code which of the half-edges found is meant, one bit for each; -1 for none."""
    for i in range(number):
        y = corners_class(size[root_of(parent, found[i] // 3)])
        c.state[CONTEXT] = CHOOSE_AT + 4 * min(i, 7) + min(number - 1 - i, 3)
        c.state[CONTEXT + 1] = CHOOSE_AT + 32 + 9 * y + 3 * (h % 3) + found[i] % 3
        if code_bit(c, 1 if found[i] == wanted else 0, np.int64(CHOOSE)) == 1:
            return found[i]
    return np.int64(-1)


@inlined
def _code_any(
    c: Coder, wanted: _Ints, order: _Ints, first: Int, end: Int, h: Int, encoding: Flag
) -> Int:
    """Code a half-edge of a group by its rank."""
    rank: Int = np.int64(0)
    if encoding:
        rank = np.searchsorted(order[first:end], wanted[h])
    return order[first + code_below(c, rank, end - first)]


@inlined
def _unlink(first: _Ints, after: _Ints, before: _Ints, group: _Ints, h: Int) -> None:
    """Take a half-edge out of its list, unless the list begins beyond it already."""
    if first[group[h]] == h:
        first[group[h]] = after[h]
    if before[h] >= 0:
        after[before[h]] = after[h]
    if after[h] >= 0:
        before[after[h]] = before[h]
