"""Hidden edges between triangles: the triangles on both sides are merged into one polygon.

Every half-edge has at most one candidate that it may be merged with, its opposite where the surface
is a manifold; further pairs are explicit (`merged_pairs`). The contexts are those of a quad mesh: a
triangle has one hidden edge, an inner vertex has four edges that are seen, one of the border three,
and hidden edges of neighbours run in parallel.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit
from deltamesh._kernels.coding.models import Model, layout
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge
from deltamesh_formats.array_types import Ints

# The status of an edge.
OPEN, SEEN, HIDDEN = 0, 1, 2

HIDE, PAIR, CHOOSE = range(3)
LIMIT = 255
MIXERS = ((4, LIMIT), (3, LIMIT), (2, LIMIT))
# The first slot of each input of the mixers: its range is indexed by its contexts.
(
    HIDE_BY_SIZES,
    HIDE_BY_ENDS,
    HIDE_BY_APEXES,
    HIDE_BY_BEYOND,
    PAIR_BY_SIZE,
    PAIR_BY_HISTORY,
    PAIR_BY_CANDIDATE,
    CHOOSE_BY_RANK,
    CHOOSE_BY_SIZE,
    SLOTS,
) = layout(
    (4, 4, 4, 4),
    (20, 20, 4),
    (20, 20, 4),
    (25, 25, 4),
    (64,),
    (64,),
    (64,),
    (8, 4),
    (64,),
)
MODEL = Model(SLOTS, MIXERS)


@inlined
def root_of(parent: Ints, t: Int) -> Int:
    """Return the triangle at the root of the polygon of one, halving the path to it."""
    while parent[t] != t:
        parent[t] = parent[parent[t]]
        t = parent[t]
    return t


@inlined
def join(merged: Ints, parent: Ints, size: Ints, h: Int, g: Int, r: Int, s: Int) -> None:
    """Merge polygons r and s across their half-edges h and g."""
    merged[h], merged[g] = g, h
    parent[s] = r
    size[r] += size[s] - 2


@inlined
def corners_class(size: Int) -> Int:
    """Return the class of a size, 0 to 3."""
    size = min(size, 6)
    return size - 3


@inlined
def _spare(seen: Ints, left: Ints, border: Ints, v: Int, own: Int) -> Int:
    """Return two counts at a vertex of a quad mesh as one: edges to be hidden, edges not coded.

    The former is -1 to 3, plus 1; the latter, without the `own` one, at most 3.
    """
    spare: Int = seen[v] + left[v] + border[v] - 4
    return 4 * (min(max(spare, -1), 3) + 1) + min(left[v] - own, 3)


@inlined
def _behind(edges: Ints, candidate: Ints, e: Int, forward: Flag) -> Int:
    """Return the status beyond an edge: 0 unknown, 4 if it is hidden itself.

    Else that of the triangle there: 1 if its edge after the shared one is hidden (before it, unless
    `forward`), else 2 if the third one is, else 3.
    """
    g = candidate[e]
    if g < 0 or edges[e] == OPEN:
        return np.int64(0)
    if edges[e] == HIDDEN:
        return np.int64(4)
    one, other = next_halfedge(g), previous_halfedge(g)
    if not forward:
        one, other = other, one
    if edges[one] == HIDDEN:
        return np.int64(1)
    return np.int64(2) if edges[other] == HIDDEN else np.int64(3)


@inlined
def _around(edges: Ints, candidate: Ints, h: Int) -> Int:
    """Return the status beyond the two other edges of a triangle, 0 to 24.

    Where triangles form a lattice, a half turn about the middle of an edge takes one to the other:
    h is hidden where the edge that this takes it to is.
    """
    after = _behind(edges, candidate, next_halfedge(h), False)
    return 5 * after + _behind(edges, candidate, previous_halfedge(h), True)


@kernel
def code_hidden(
    c: Coder,
    corners: Ints,
    count: Int,
    candidate: Ints,
    merged: Ints,
    parent: Ints,
    size: Ints,
    least: Int,
    most: Int,
    more: Flag,
) -> None:
    """Code which half-edges are merged with their candidates.

    corners : int64 (3 m,), the vertices of triangles, in [0, count).
    candidate : int64 (3 m,), the half-edge that each may be merged with, -1 for none.
    merged : int64 (3 m,), the half-edge that each is merged with, -1 for none; when decoding, -1,
        and filled in. Others than the candidates are ignored.
    parent, size : int64 (m,), the forest of polygons so far, and the corners of each root's.
    least, most : bounds of the corners of a polygon.
    more : whether explicit pairs of half-edges follow.
    """
    m = len(corners) // 3
    state = c.state
    edges = np.full(3 * m, OPEN, np.int64)
    open_pairs = np.zeros(m, np.int64)  # those of a polygon, twice those within it
    seen, left, border = np.zeros((3, count), np.int64)
    for h in range(3 * m):
        a = corners[h]
        if candidate[h] >= 0:
            open_pairs[h // 3] += 1
            left[a] += 1  # a pair is counted once at each of its ends
            continue
        edges[h] = SEEN
        b = corners[next_halfedge(h)]
        seen[a] += 1
        seen[b] += 1
        border[a] = border[b] = 1
    for h in range(3 * m):
        g = candidate[h]
        if g < 0 or g // 3 > h // 3 or edges[h] != OPEN:
            continue
        a, b = corners[h], corners[g]
        r, s = root_of(parent, h // 3), root_of(parent, g // 3)
        bit = 1 if merged[h] == g else 0
        if r == s or size[r] + size[s] - 2 > most:
            bit = 0
        elif not more and (
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
            beyond = 25 * _around(edges, candidate, h) + _around(edges, candidate, g)
            state[CONTEXT] = HIDE_BY_SIZES + 64 * x + 16 * y + 4 * (i - 1) + j - 1
            state[CONTEXT + 1] = HIDE_BY_ENDS + 4 * ends + joined
            state[CONTEXT + 2] = HIDE_BY_APEXES + 4 * apexes + joined
            state[CONTEXT + 3] = HIDE_BY_BEYOND + 4 * beyond + joined
            bit = code_bit(c, bit, np.int64(HIDE))
        open_pairs[r] -= 1
        open_pairs[s] -= 1
        left[a] -= 1
        left[b] -= 1
        if bit == 1:
            edges[h] = edges[g] = HIDDEN
            join(merged, parent, size, h, g, r, s)
            open_pairs[r] += open_pairs[s]
        else:
            edges[h] = edges[g] = SEEN
            seen[a] += 1
            seen[b] += 1
