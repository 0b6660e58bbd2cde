"""Order of the vertices of a mesh, in steps (`coding.steps`)."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, DECODING, Coder, code_bit
from deltamesh._kernels.coding.remaining import (
    Remaining,
    Rings,
    all_of,
    leave_ring,
    next_left,
    remove,
    rings_of,
)
from deltamesh._kernels.coding.residual import KNOWN
from deltamesh._kernels.coding.steps import (
    ANY,
    CANDIDATES,
    CHOICE,
    CHOOSE,
    CHOOSE_MIXER,
    CHOOSE_SIZE,
    CORRUPT,
    NEAR,
    NEXT,
    OK,
    REMEMBERED,
    SCANNED,
    TRAILS,
    code_anchor,
    code_any,
    code_step,
    follow,
    index_of,
    near,
    trail_of,
)
from deltamesh._kernels.jit import Int, inlined, kernel
from deltamesh_formats.array_types import Ints


@kernel
def code_vertices(
    c: Coder,
    indptr: Ints,
    indices: Ints,
    mirror: Ints,
    newest: Int,
    order: Ints,
    margin: Int,
    stop: Int,
) -> Int:
    """Code the vertex of each rank, `order` (n,), filled in place when decoding.

    The neighbours are as `adjacency.adjacency` returns them; entry e, of row v, is the edge from v
    to `indices[e]`, and `mirror[e]` the entry of the edge back. The anchor of a vertex is the
    newest or the oldest of its neighbours that have a rank. At most `stop` ranks are coded. Return
    OK or CORRUPT.
    """
    n = len(order)
    encoding = c.state[DECODING] == 0
    left = all_of(np.int64(n))
    rings = rings_of(np.repeat(np.arange(n), np.diff(indptr)), np.int64(n))
    # The ranks of the oldest and the newest neighbour of each vertex, -1 without, and their number.
    around = np.full((n, 3), -1, np.int64)
    around[:, 2] = 0
    memory, known = np.zeros(REMEMBERED, np.int64), np.zeros(KNOWN, np.int64)
    trails = np.zeros((TRAILS, 3), np.int64)
    value, found = np.zeros(1, np.int64), np.empty(CANDIDATES, np.int64)
    last = np.zeros(3, np.int64)  # `around` of the vertex before, when it got its rank
    key = newest
    previous = np.int64(-1)
    for i in range(min(n, stop)):
        vertex = order[i] if encoding else np.int64(-1)
        following = next_left(left, previous + 1)
        step, count, trail = np.int64(NEXT), 0, -1
        if encoding and vertex != following:
            step = np.int64(ANY)
            anchor = around[vertex, key]
            trail = trail_of(trails, anchor, n - i, margin) if anchor >= 0 else -1
            if trail >= 0:
                count = _around_anchor(rings, indices, around, key, order[anchor], anchor, found)
                step = np.int64(NEAR) if index_of(found, count, vertex) >= 0 else step
        follows = min(around[following, 2], 1) * (2 if around[following, 1] == i - 1 else 1)
        step = code_step(c, step, memory, trails, follows, i > 0)
        if step == NEXT:
            vertex = following
        elif step == NEAR:
            anchor = around[vertex, key] if encoding else np.int64(0)
            anchor = code_anchor(c, anchor, trail, memory, trails, known, value)
            if not 0 <= anchor < i:
                return CORRUPT
            count = _around_anchor(rings, indices, around, key, order[anchor], anchor, found)
            if count == 0:
                return CORRUPT
            vertex = _choose_vertex(c, memory, around, last, found, count, i, vertex)
        else:
            vertex = code_any(c, left, vertex, n - i)
        order[i] = vertex
        last[:] = around[vertex]
        follow(trails, around[vertex, key] if around[vertex, key] >= 0 else i)
        _rank_vertex(left, rings, indptr, indices, mirror, around, vertex, i)
        previous = vertex
    return OK


@kernel
def _around_anchor(
    rings: Rings, indices: Ints, around: Ints, key: Int, hub: Int, anchor: Int, found: Ints
) -> Int:
    """Find the neighbours of `hub`, of rank `anchor`, that are left and have it for an anchor."""
    count, e = 0, rings.start[hub]
    for _ in range(SCANNED):
        if e < 0 or count == CANDIDATES:
            break
        if around[indices[e], key] == anchor:
            found[count] = indices[e]
            count += 1
        e = rings.after[e]
        if e == rings.start[hub]:
            break
    return count


@kernel
def _choose_vertex(
    c: Coder,
    memory: Ints,
    around: Ints,
    last: Ints,
    found: Ints,
    count: Int,
    rank: Int,
    vertex: Int,
) -> Int:
    """Code which of the vertices found is meant, one bit for each but the last."""
    state = c.state
    for k in range(count):
        w = found[k]
        old, new = near(around[w, 0], last[0]), near(around[w, 1], last[1])
        touches = 1 if around[w, 1] == rank - 1 else 0
        degree, at = min(around[w, 2], 3), min(k, 3)
        kind = 2 * old + touches
        if k < count - 1:
            state[CONTEXT] = CHOOSE + 4 * kind + degree
            state[CONTEXT + 1] = CHOOSE + CHOOSE_SIZE + 16 * kind + memory[CHOICE]
            state[CONTEXT + 2] = CHOOSE + 2 * CHOOSE_SIZE + 24 * degree + 6 * at + new
            if code_bit(c, 1 if w == vertex else 0, np.int64(CHOOSE_MIXER)) == 0:
                continue
        memory[CHOICE] = kind
        return w
    return np.int64(-1)


@inlined
def _rank_vertex(
    left: Remaining,
    rings: Rings,
    indptr: Ints,
    indices: Ints,
    mirror: Ints,
    around: Ints,
    vertex: Int,
    rank: Int,
) -> None:
    """Give a vertex its rank, and bring `around` and the rings up to date."""
    remove(left, vertex)
    for e in range(indptr[vertex], indptr[vertex + 1]):
        w = indices[e]
        leave_ring(rings, w, mirror[e])
        if around[w, 0] < 0:
            around[w, 0] = rank
        around[w, 1] = rank
        around[w, 2] += 1
