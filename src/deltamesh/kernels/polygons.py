"""Which edges between triangles are hidden, so that the triangles on both sides are one polygon.

Every half-edge has at most one partner that it may be hidden with, the one across the edge where
the surface is a manifold. What else polygons are glued over is listed. Hidden edges are known by
what a quad mesh looks like: a triangle has one hidden edge, an inner vertex has four edges that
are seen, one of the border three, and hidden edges of neighbours run in parallel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.coder import CONTEXT, Coder, code_bit
from deltamesh.kernels.jit import Flag, Int, inlined, kernel
from deltamesh.kernels.topology import next_halfedge, previous_halfedge
from deltamesh.kernels.valence import code_below

_Ints = NDArray[np.int64]

# What is known of an edge.
OPEN, SEEN, HIDDEN = 0, 1, 2

# Of an edge with many triangles, so many half-edges are looked at, and so many that fit taken.
SCANNED = 64
CANDIDATES = 16

HIDE, LIST, CHOOSE = range(3)
LIMIT = 255
MIXERS = ((4, LIMIT), (3, LIMIT), (2, LIMIT))
SIZES = 0
ENDS = SIZES + 256
APEXES = ENDS + 1600
ACROSS = APEXES + 1600
LIST_AT = ACROSS + 2500
CHOOSE_AT = LIST_AT + 3 * 64
SLOTS = CHOOSE_AT + 32 + 64


@inlined
def root_of(parent: _Ints, t: Int) -> Int:
    """Return the triangle that stands for the polygon of one, halving the way there."""
    while parent[t] != t:
        parent[t] = parent[parent[t]]
        t = parent[t]
    return t


@inlined
def _join(glued: _Ints, parent: _Ints, size: _Ints, h: Int, g: Int, r: Int, s: Int) -> None:
    """Hide half-edges h and g of polygons r and s."""
    glued[h], glued[g] = g, h
    parent[s] = r
    size[r] += size[s] - 2


@inlined
def _corners(size: Int) -> Int:
    """Return a size as one of four."""
    size = min(size, 6)
    return size - 3


@inlined
def _spare(seen: _Ints, left: _Ints, border: _Ints, v: Int, own: Int) -> Int:
    """Return how many edges are still to be hidden at a vertex of a quad mesh, and how many left.

    The former is -1 to 3, plus 1; the latter, without the `own` one, at most 3.
    """
    spare: Int = seen[v] + left[v] + border[v] - 4
    return 4 * (min(max(spare, -1), 3) + 1) + min(left[v] - own, 3)


@inlined
def _behind(state: _Ints, partner: _Ints, e: Int, forward: Flag) -> Int:
    """Return what is known beyond an edge: 0 nothing, 4 that it is hidden itself.

    Else of the triangle there: 1 if its edge after the shared one is hidden (before it, unless
    `forward`), else 2 if the third one is, else 3.
    """
    g = partner[e]
    if g < 0 or state[e] == OPEN:
        return np.int64(0)
    if state[e] == HIDDEN:
        return np.int64(4)
    one, other = next_halfedge(g), previous_halfedge(g)
    if not forward:
        one, other = other, one
    if state[one] == HIDDEN:
        return np.int64(1)
    return np.int64(2) if state[other] == HIDDEN else np.int64(3)


@inlined
def _around(state: _Ints, partner: _Ints, h: Int) -> Int:
    """Return what is known beyond the two other edges of a triangle, 0 to 24.

    Where triangles form a lattice, a half turn about the middle of an edge takes one to the other:
    h is hidden where the edge that it is turned to is.
    """
    after = _behind(state, partner, next_halfedge(h), False)
    return 5 * after + _behind(state, partner, previous_halfedge(h), True)


@kernel
def code_hidden(
    c: Coder,
    corners: _Ints,
    count: Int,
    partner: _Ints,
    glued: _Ints,
    parent: _Ints,
    size: _Ints,
    least: Int,
    most: Int,
    listed: Flag,
) -> None:
    """Code which half-edges are hidden with their partners.

    corners : int64 (3 m,), the vertices of triangles, in [0, count).
    partner : int64 (3 m,), the half-edge that each may be glued to, -1 for none.
    glued : int64 (3 m,), the half-edge that each is glued to, -1 for none; when decoding, -1, and
        filled in. What is no partner is ignored.
    parent, size : int64 (m,), the forest of polygons so far, and the corners of each root's.
    least, most : bounds of the corners of a polygon.
    listed : whether further half-edges will be glued.
    """
    m = len(corners) // 3
    k = c.state
    state = np.full(3 * m, OPEN, np.int64)
    open_pairs = np.zeros(m, np.int64)  # those of a polygon, twice those within it
    seen, left, border = np.zeros((3, count), np.int64)
    for h in range(3 * m):
        a = corners[h]
        if partner[h] >= 0:
            open_pairs[h // 3] += 1
            left[a] += 1  # a pair is counted once at each of its ends
            continue
        state[h] = SEEN
        b = corners[next_halfedge(h)]
        seen[a] += 1
        seen[b] += 1
        border[a] = border[b] = 1
    for h in range(3 * m):
        g = partner[h]
        if g < 0 or g // 3 > h // 3 or state[h] != OPEN:
            continue
        a, b = corners[h], corners[g]
        r, s = root_of(parent, h // 3), root_of(parent, g // 3)
        bit = 1 if glued[h] == g else 0
        if r == s or size[r] + size[s] - 2 > most:
            bit = 0
        elif not listed and (
            (size[r] < least and open_pairs[r] == 1) or (size[s] < least and open_pairs[s] == 1)
        ):
            bit = 1
        else:
            p, q = corners[previous_halfedge(h)], corners[previous_halfedge(g)]
            x, y = _corners(size[r]), _corners(size[s])
            i: Int = min(open_pairs[r], 4)
            j: Int = min(open_pairs[s], 4)
            joined = 2 * (1 if x > 0 else 0) + (1 if y > 0 else 0)
            ends = 20 * _spare(seen, left, border, a, 1) + _spare(seen, left, border, b, 1)
            apexes = 20 * _spare(seen, left, border, p, 0) + _spare(seen, left, border, q, 0)
            beyond = 25 * _around(state, partner, h) + _around(state, partner, g)
            k[CONTEXT] = SIZES + 64 * x + 16 * y + 4 * (i - 1) + j - 1
            k[CONTEXT + 1] = ENDS + 4 * ends + joined
            k[CONTEXT + 2] = APEXES + 4 * apexes + joined
            k[CONTEXT + 3] = ACROSS + 4 * beyond + joined
            bit = code_bit(c, bit, np.int64(HIDE))
        open_pairs[r] -= 1
        open_pairs[s] -= 1
        left[a] -= 1
        left[b] -= 1
        if bit == 1:
            state[h] = state[g] = HIDDEN
            _join(glued, parent, size, h, g, r, s)
            open_pairs[r] += open_pairs[s]
        else:
            state[h] = state[g] = SEEN
            seen[a] += 1
            seen[b] += 1


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
    glued, parent, size : see `code_hidden`; filled in.
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
        x, rich = _corners(size[r]), min(number, 3)
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
        _join(glued, parent, size, h, g, r, root_of(parent, g // 3))
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
        y = _corners(size[root_of(parent, found[i] // 3)])
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


@kernel
def walk(glued: _Ints, corners: _Ints, offsets: _Ints, of_corners: _Ints) -> None:
    """List the corners of the polygons, ascending by their lowest triangles.

    glued : int64 (3 m,), the half-edge that each is glued to, -1 for none; no ring of triangles.
    corners : int64 (c,), offsets : int64 (p + 1,), of_corners : int64 (3 m,), filled in; see
        `polygons.Polygons`.
    """
    of_corners[:] = -1
    at, number = 0, 0
    for t in range(len(glued) // 3):
        if of_corners[3 * t] >= 0:
            continue
        start: Int = 3 * t
        most = 0
        for h in range(3 * t, 3 * t + 3):
            e: Int = h  # first to where the corner begins, then over all of it
            meeting = 1
            while glued[e] >= 0:
                e = next_halfedge(glued[e])
            f: Int = e
            while glued[previous_halfedge(f)] >= 0:
                f = glued[previous_halfedge(f)]
                meeting += 1
            if meeting > most:
                start, most = e, meeting
        e = start
        while True:
            corners[at] = e
            of_corners[e] = at
            f = e
            while glued[previous_halfedge(f)] >= 0:
                f = glued[previous_halfedge(f)]
                of_corners[f] = at
            at += 1
            e = next_halfedge(e)
            while glued[e] >= 0:
                e = next_halfedge(glued[e])
            if e == start:
                break
        number += 1
        offsets[number] = at
