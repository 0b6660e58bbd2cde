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

from deltamesh.kernels.coder import CONTEXT, DECODING, Coder, code_bit
from deltamesh.kernels.jit import Flag, Int, inlined, kernel
from deltamesh.kernels.remaining import (
    Remaining,
    Rings,
    all_of,
    count_below,
    leave_ring,
    next_left,
    remove,
    rings_of,
    select,
)
from deltamesh.kernels.residual import (
    ABSOLUTE,
    AXIS_MIXERS,
    AXIS_SLOTS,
    HINT,
    KIND,
    KNOWN,
    LAST,
    NEIGHBOURS,
    SUM,
    code_vector,
    level,
)
from deltamesh.kernels.residual import MIXERS as VECTOR_MIXERS
from deltamesh.kernels.valence import code_below

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
TRAIL_BITS = 4
TRAILS = 1 << TRAIL_BITS
ANCHOR, DISTANCE, DISTANCE_BEFORE = range(3)
REACH = 32

# Slots and mixers: the distances, as vectors of one coordinate; then those of the ways, of the
# choice at an anchor, and of the turn of a face.
WAY_INPUTS, CHOICE_INPUTS, TURN_INPUTS = 3, 5, 5
WAY = AXIS_SLOTS
WAY_SIZE = 512
CHOOSE = WAY + 2 * WAY_INPUTS * WAY_SIZE
CHOOSE_SIZE = 1024
TURN = CHOOSE + CHOICE_INPUTS * CHOOSE_SIZE
TURN_SIZE = 2048
TRACK = TURN + 2 * TURN_INPUTS * TURN_SIZE
TRACK_INPUTS, TRACK_SIZE = 2, 256
SLOTS = TRACK + TRACK_INPUTS * TRACK_SIZE
WAY_MIXER, CHOOSE_MIXER, TURN_MIXER = AXIS_MIXERS, AXIS_MIXERS + 2, AXIS_MIXERS + 3
TRACK_MIXER = TURN_MIXER + 2
LIMIT = 255
MIXERS = (
    *VECTOR_MIXERS[:AXIS_MIXERS],
    *((WAY_INPUTS, LIMIT),) * 2,
    (CHOICE_INPUTS, LIMIT),
    *((TURN_INPUTS, LIMIT),) * 2,
    (TRACK_INPUTS, LIMIT),
)


@inlined
def _near(a: Int, b: Int) -> Int:
    """Return a - b as one of six classes: at most -2, -1, 0, 1, 2, above."""
    return min(max(a - b, -2), 3) + 2


@inlined
def _bits(x: Int) -> Int:
    n = np.int64(0)
    while x >> n > 0:
        n += 1
    return n


@kernel
def _trail_of(trails: _Ints, anchor: Int, left: Int) -> Int:
    """Return the trail from which to tell an anchor, -1 where a rank among `left` takes less."""
    best, least = -1, _bits(left)
    for k in range(TRAILS):
        cost = 2 * _bits(abs(anchor - trails[k, ANCHOR])) + (2 if k == 0 else 6)
        if cost < least:
            best, least = k, cost
    return best


@kernel
def _follow(trails: _Ints, anchor: Int) -> None:
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
def _code_way(c: Coder, way: Int, memory: _Ints, trails: _Ints, follows: Int, has_anchor: Flag) -> Int:
    """Code how the step is told; `follows`, below 4, is how the next one left is to the last."""
    state, history = c.state, memory[HISTORY]
    far = level(abs(trails[0, DISTANCE])) // 2
    for k in range(2 if has_anchor else 1):
        base = WAY + k * WAY_INPUTS * WAY_SIZE
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
def _code_anchor(
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
def _code_any(c: Coder, left: Remaining, element: Int, count: Int) -> Int:
    """Code an element by its rank among those that are left; -1 if there is none of that rank."""
    rank = code_below(c, count_below(left, element) if element >= 0 else 0, count)
    return select(left, rank) if rank < count else np.int64(-1)


# ---- Vertices ----------------------------------------------------------------------------------


@kernel
def code_vertices(
    c: Coder, indptr: _Ints, indices: _Ints, mirror: _Ints, newest: Flag, order: _Ints, stop: Int
) -> Int:
    """Code which vertex is at each place, `order` (n,), filled in place when decoding.

    The neighbours are as of `adjacency`; entry e, of row v, is the edge from v to `indices[e]`, and
    `mirror[e]` the entry of the way back. The anchor of a vertex is the newest or the oldest of its
    neighbours that have a place. At most `stop` places are coded. Returns OK or CORRUPT.
    """
    n = len(order)
    encoding = c.state[DECODING] == 0
    left = all_of(np.int64(n))
    rings = rings_of(np.repeat(np.arange(n), np.diff(indptr)), np.int64(n))
    # The places of the oldest and the newest neighbour of each vertex, -1 without, and how many.
    around = np.full((n, 3), -1, np.int64)
    around[:, 2] = 0
    memory, known = np.zeros(REMEMBERED, np.int64), np.zeros(KNOWN, np.int64)
    trails = np.zeros((TRAILS, 3), np.int64)
    value, found = np.zeros(1, np.int64), np.empty(CANDIDATES, np.int64)
    last = np.zeros(3, np.int64)  # `around` of the vertex before, when it got its place
    key = 1 if newest else 0
    previous = np.int64(-1)
    for i in range(min(n, stop)):
        vertex = order[i] if encoding else np.int64(-1)
        following = next_left(left, previous + 1)
        way, count, trail = np.int64(NEXT), 0, -1
        if encoding and vertex != following:
            way = np.int64(ANY)
            anchor = around[vertex, key]
            trail = _trail_of(trails, anchor, n - i) if anchor >= 0 else -1
            if trail >= 0:
                count = _around_anchor(rings, indices, around, key, order[anchor], anchor, found)
                way = np.int64(NEAR) if _index(found, count, vertex) >= 0 else way
        follows = 2 * (around[following, 1] == i - 1) + (around[following, 1] >= 0)
        way = _code_way(c, way, memory, trails, follows, i > 0)
        if way == NEXT:
            vertex = following
        elif way == NEAR:
            anchor = around[vertex, key] if encoding else np.int64(0)
            anchor = _code_anchor(c, anchor, trail, memory, trails, known, value)
            if not 0 <= anchor < i:
                return CORRUPT
            count = _around_anchor(rings, indices, around, key, order[anchor], anchor, found)
            if count == 0:
                return CORRUPT
            vertex = _choose_vertex(c, memory, around, last, found, count, i, vertex)
        else:
            vertex = _code_any(c, left, vertex, n - i)
            if vertex < 0:
                return CORRUPT
        order[i] = vertex
        last[:] = around[vertex]
        _follow(trails, around[vertex, key] if around[vertex, key] >= 0 else i)
        _place_vertex(left, rings, indptr, indices, mirror, around, vertex, i)
        previous = vertex
    return OK


@inlined
def _index(found: _Ints, count: Int, element: Int) -> Int:
    for k in range(count):
        if found[k] == element:
            return k
    return -1


@kernel
def _around_anchor(
    rings: Rings, indices: _Ints, around: _Ints, key: Int, hub: Int, anchor: Int, found: _Ints
) -> Int:
    """Find the neighbours of `hub`, at place `anchor`, that are left and have it for an anchor."""
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
    memory: _Ints,
    around: _Ints,
    last: _Ints,
    found: _Ints,
    count: Int,
    place: Int,
    vertex: Int,
) -> Int:
    """Code which of the vertices found is meant, one bit for each but the last."""
    state = c.state
    for k in range(count):
        w = found[k]
        old, new = _near(around[w, 0], last[0]), _near(around[w, 1], last[1])
        touches = 1 if around[w, 1] == place - 1 else 0
        degree, at = min(around[w, 2], 3), min(k, 3)
        look = 2 * old + touches
        if k < count - 1:
            state[CONTEXT] = CHOOSE + 4 * look + degree
            state[CONTEXT + 1] = CHOOSE + CHOOSE_SIZE + 8 * degree + 2 * at + touches
            state[CONTEXT + 2] = CHOOSE + 2 * CHOOSE_SIZE + 16 * look + memory[CHOICE]
            state[CONTEXT + 3] = CHOOSE + 3 * CHOOSE_SIZE + 6 * old + new
            state[CONTEXT + 4] = CHOOSE + 4 * CHOOSE_SIZE + 24 * degree + 6 * at + new
            if code_bit(c, 1 if w == vertex else 0, np.int64(CHOOSE_MIXER)) == 0:
                continue
        memory[CHOICE] = look
        return w
    return np.int64(-1)


@inlined
def _place_vertex(
    left: Remaining,
    rings: Rings,
    indptr: _Ints,
    indices: _Ints,
    mirror: _Ints,
    around: _Ints,
    vertex: Int,
    place: Int,
) -> None:
    remove(left, vertex)
    for e in range(indptr[vertex], indptr[vertex + 1]):
        w = indices[e]
        leave_ring(rings, w, mirror[e])
        if around[w, 0] < 0:
            around[w, 0] = place
        around[w, 1] = place
        around[w, 2] += 1


# ---- Faces -------------------------------------------------------------------------------------


@kernel
def code_faces(
    c: Coder,
    faces: _Ints,
    places: _Ints,
    placed: Int,
    mode: Int,
    order: _Ints,
    turns: _Ints,
    stop: Int,
) -> Int:
    """Code which face comes when, `order` (m,), and at which corner it begins, `turns` (m,).

    Both are filled in place when decoding. `places` (n,) are the places of the vertices, -1 without
    one; `placed` have one, and the others get the next ones as faces come to use them. The anchor
    of a face is its FIRST vertex, or the OLDEST or NEWEST of those with a place. At most `stop`
    faces are coded. Returns OK or CORRUPT.
    """
    m, n = len(faces), len(places)
    encoding = c.state[DECODING] == 0
    at = np.full(n, -1, np.int64)  # the vertex at each place
    for v in range(n):
        if places[v] >= 0:
            at[places[v]] = v
    left = all_of(np.int64(m))
    rings = rings_of(faces.ravel(), np.int64(n))
    memory, known = np.zeros(REMEMBERED, np.int64), np.zeros(KNOWN, np.int64)
    trails = np.zeros((TRAILS, 3), np.int64)
    value, found = np.zeros(1, np.int64), np.empty(CANDIDATES, np.int64)
    # The vertices of the last two faces, as they came; no vertex at first.
    recent = np.full((2, 3), -1, np.int64)
    turned = np.zeros(3, np.int64)
    previous = np.int64(-1)
    for i in range(min(m, stop)):
        face, turn = (order[i], turns[i]) if encoding else (np.int64(-1), np.int64(0))
        following = next_left(left, previous + 1)
        way, count, trail = np.int64(NEXT), 0, -1
        if encoding and face != following:
            way = np.int64(ANY)
            corner = _anchor_corner(faces, places, mode, face, turn)
            anchor = places[faces[face, corner]]
            trail = _trail_of(trails, anchor, m - i) if anchor >= 0 else -1
            if trail >= 0:
                count = _at_anchor(rings, faces, places, mode, at[anchor], found)
                way = np.int64(NEAR) if _index(found, count, 3 * face + corner) >= 0 else way
        follows = _shared(faces, following, recent[0])
        way = _code_way(c, way, memory, trails, follows, placed > 0)
        if way == NEXT:
            face = following
        elif way == NEAR:
            corner, anchor = np.int64(0), np.int64(0)
            if encoding:
                corner = _anchor_corner(faces, places, mode, face, turn)
                anchor = places[faces[face, corner]]
            anchor = _code_anchor(c, anchor, trail, memory, trails, known, value)
            if not 0 <= anchor < placed:
                return CORRUPT
            count = _at_anchor(rings, faces, places, mode, at[anchor], found)
            if count == 0:
                return CORRUPT
            chosen = _choose_face(
                c, memory, faces, places, mode, recent, found, count, 3 * face + corner
            )
            face = chosen // 3
            if mode == FIRST:
                turn = chosen % 3
        else:
            face = _code_any(c, left, face, m - i)
            if face < 0:
                return CORRUPT
        if way != NEAR or mode != FIRST:
            turn = _code_turn(c, faces, places, mode, recent, turned, way, face, turn)
        order[i], turns[i] = face, turn
        remove(left, face)
        recent[1] = recent[0]
        for j in range(3):
            v = faces[face, j]
            leave_ring(rings, v, 3 * face + j)
            v = faces[face, (turn + j) % 3]
            recent[0, j] = v
            if places[v] < 0:
                places[v], at[placed] = placed, v
                placed += 1
        _follow(trails, places[faces[face, _anchor_corner(faces, places, mode, face, turn)]])
        previous = face
    return OK


@inlined
def _place(places: _Ints, v: Int) -> Int:
    """Return the place of a vertex; without one, it is after all that have one."""
    return places[v] if places[v] >= 0 else np.int64(1) << 60


@inlined
def _anchor_corner(faces: _Ints, places: _Ints, mode: Int, face: Int, turn: Int) -> Int:
    """Return the corner of a face that is its anchor, the first of equals."""
    if mode == FIRST:
        return np.int64(turn)
    best = np.int64(0)
    for j in range(1, 3):
        new, old = places[faces[face, j]], places[faces[face, best]]
        if mode == NEWEST:
            better = new > old
        else:
            better = new >= 0 and (old < 0 or new < old)
        if better:
            best = np.int64(j)
    return best


@kernel
def _at_anchor(
    rings: Rings, faces: _Ints, places: _Ints, mode: Int, hub: Int, found: _Ints
) -> Int:
    """Find the corners at `hub` of faces that are left and have it for an anchor."""
    count, e = 0, rings.start[hub]
    for _ in range(SCANNED):
        if e < 0 or count == CANDIDATES:
            break
        if mode == FIRST or _anchor_corner(faces, places, mode, e // 3, np.int64(0)) == e % 3:
            found[count] = e
            count += 1
        e = rings.after[e]
        if e == rings.start[hub]:
            break
    return count


@inlined
def _shared(faces: _Ints, face: Int, others: _Ints) -> Int:
    """Return how many corners of a face are among three vertices."""
    count = 0
    for j in range(3):
        v = faces[face, j]
        count += 1 if (v == others[0] or v == others[1] or v == others[2]) else 0
    return count


@kernel
def _choose_face(
    c: Coder,
    memory: _Ints,
    faces: _Ints,
    places: _Ints,
    mode: Int,
    recent: _Ints,
    found: _Ints,
    count: Int,
    corner: Int,
) -> Int:
    """Code which of the corners found is meant, one bit for each but the last."""
    state = c.state
    for k in range(count):
        face, j = found[k] // 3, found[k] % 3
        shared, before = _shared(faces, face, recent[0]), _shared(faces, face, recent[1])
        a = places[faces[face, j]]
        b, d = _place(places, faces[face, (j + 1) % 3]), _place(places, faces[face, (j + 2) % 3])
        fresh = (1 if b > a + (1 << 50) else 0) + (1 if d > a + (1 << 50) else 0)
        ahead = _like(places, recent[0], a, b, d) + 2 * _like(places, recent[1], a, b, d)
        third = b if (b < d) == (mode == NEWEST) else d
        lead = _near(third, memory[CHOICE]) if third < 1 << 50 else np.int64(6)
        at = min(k, 3)
        if k < count - 1:
            state[CONTEXT] = CHOOSE + 12 * shared + 3 * before + fresh
            state[CONTEXT + 1] = CHOOSE + CHOOSE_SIZE + 16 * ahead + 4 * shared + fresh
            state[CONTEXT + 2] = CHOOSE + 2 * CHOOSE_SIZE + 16 * lead + 4 * shared + fresh
            state[CONTEXT + 3] = CHOOSE + 3 * CHOOSE_SIZE + 16 * at + 4 * shared + fresh
            state[CONTEXT + 4] = CHOOSE + 4 * CHOOSE_SIZE + 16 * lead + 4 * ahead + at
            if code_bit(c, 1 if found[k] == corner else 0, np.int64(CHOOSE_MIXER)) == 0:
                continue
        memory[CHOICE] = min(third, np.int64(1) << 50)
        return found[k]
    return np.int64(-1)


@inlined
def _like(places: _Ints, others: _Ints, a: Int, b: Int, d: Int) -> Int:
    """Tell whether places lie to each other as those of an earlier face do, from some corner."""
    result = 0
    for j in range(3):
        if others[j] >= 0:
            e = places[others[j]]
            f, g = places[others[(j + 1) % 3]], places[others[(j + 2) % 3]]
            if f - e == b - a and g - e == d - a:
                result = 1
    return result


@kernel
def _code_turn(
    c: Coder,
    faces: _Ints,
    places: _Ints,
    mode: Int,
    recent: _Ints,
    turned: _Ints,
    way: Int,
    face: Int,
    turn: Int,
) -> Int:
    """Code at which corner a face begins, from a corner that its vertices single out."""
    state = c.state
    base = _anchor_corner(faces, places, OLDEST if mode == FIRST else mode, face, np.int64(0))
    mask, pattern = 0, 0
    for j in range(3):
        v = faces[face, (base + j) % 3]
        where = 3
        for k in range(3):
            if recent[0, k] == v:
                where = min(where, k)
        mask = 2 * mask + (1 if where < 3 else 0)
        pattern = 4 * pattern + where
    b, d = (
        _place(places, faces[face, (base + 1) % 3]),
        _place(places, faces[face, (base + 2) % 3]),
    )
    rising = 0 if b < d else (1 if d < b else 2)
    straight = (3 - base) % 3
    result = (turn - base) % 3
    for k in range(2):
        at = TURN + k * TURN_INPUTS * TURN_SIZE
        state[CONTEXT] = at + 9 * rising + turned[0]
        state[CONTEXT + 1] = at + TURN_SIZE + 24 * (turned[0] % 3) + 3 * mask + rising
        state[CONTEXT + 2] = at + 2 * TURN_SIZE + 36 * turned[1] + 12 * straight + way
        state[CONTEXT + 3] = at + 3 * TURN_SIZE + 3 * pattern + turned[0] % 3
        state[CONTEXT + 4] = at + 4 * TURN_SIZE + 24 * straight + 8 * rising + mask
        if code_bit(c, 1 if result == k else 0, TURN_MIXER + k) == 1:
            result = np.int64(k)
            break
        if k == 1:
            result = np.int64(2)
    turned[0] = turned[0] % 3 * 3 + result
    turned[1] = turned[1] % 2 * 2 + (1 if result == straight else 0)
    return (base + result) % 3
