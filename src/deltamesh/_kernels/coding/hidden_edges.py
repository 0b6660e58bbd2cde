"""Which edges between triangles are hidden, so that the triangles on both sides are one polygon.

Every half-edge has at most one partner that it may be hidden with, the one across the edge where
the surface is a manifold. What else polygons are glued over is listed. Hidden edges are known by
what a quad mesh looks like: a triangle has one hidden edge, an inner vertex has four edges that
are seen, one of the border three, and hidden edges of neighbours run in parallel.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge

_Ints = NDArray[np.int64]

# What is known of an edge.
OPEN, SEEN, HIDDEN = 0, 1, 2

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
def join(glued: _Ints, parent: _Ints, size: _Ints, h: Int, g: Int, r: Int, s: Int) -> None:
    """Hide half-edges h and g of polygons r and s."""
    glued[h], glued[g] = g, h
    parent[s] = r
    size[r] += size[s] - 2


@inlined
def corners_class(size: Int) -> Int:
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
            x, y = corners_class(size[r]), corners_class(size[s])
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
            join(glued, parent, size, h, g, r, s)
            open_pairs[r] += open_pairs[s]
        else:
            state[h] = state[g] = SEEN
            seen[a] += 1
            seen[b] += 1
