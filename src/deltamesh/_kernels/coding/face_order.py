"""Order of the polygons of a mesh, and their rotations, in steps (`coding.steps`)."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, DECODING, Coder, code_bit
from deltamesh._kernels.coding.remaining import (
    Rings,
    all_of,
    leave_ring,
    next_left,
    remove,
    rings_of,
)
from deltamesh._kernels.coding.residual import KNOWN
from deltamesh._kernels.coding.rotation import anchor_corner, code_rotation, code_skipped, rank_of
from deltamesh._kernels.coding.steps import (
    ANY,
    CANDIDATES,
    CHOICE,
    CHOOSE,
    CHOOSE_MIXER,
    CHOOSE_SIZE,
    CORRUPT,
    FIRST,
    LARGEST_RANK,
    NEAR,
    NEWEST,
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
def code_faces(
    c: Coder,
    faces: Ints,
    corners: Ints,
    offsets: Ints,
    within: Ints,
    rank: Ints,
    ranked: Int,
    mode: Int,
    order: Ints,
    rotations: Ints,
    margin: Int,
    stop: Int,
) -> Int:
    """Code which polygon comes when, `order` (m,), and at which corner it begins, `rotations` (m,).

    Both are filled in place when decoding. The vertices of a polygon are `corners[offsets[i]:
    offsets[i + 1]]`; a triangle represents it, `faces` (m, 3), at whose corners are those by
    `within` (m, 3). `rank` (n,) has the ranks of the vertices, -1 without one; `ranked` have one,
    and the others get the next ones as polygons come to use them. The anchor of a polygon is its
    FIRST vertex, or the OLDEST or NEWEST of those with a rank. At most `stop` polygons are coded.
    Returns OK or CORRUPT.
    """
    m, n = len(faces), len(rank)
    encoding = c.state[DECODING] == 0
    at = np.full(n, -1, np.int64)  # the vertex of each rank
    for v in range(n):
        if rank[v] >= 0:
            at[rank[v]] = v
    left = all_of(np.int64(m))
    rings = rings_of(faces.ravel(), np.int64(n))
    memory, known = np.zeros(REMEMBERED, np.int64), np.zeros(KNOWN, np.int64)
    trails = np.zeros((TRAILS, 3), np.int64)
    value, found = np.zeros(1, np.int64), np.empty(CANDIDATES, np.int64)
    # The vertices of the last two faces, as they came; no vertex at first.
    recent = np.full((2, 3), -1, np.int64)
    rotated, skips = np.zeros(3, np.int64), np.zeros(1, np.int64)
    previous = np.int64(-1)
    for i in range(min(m, stop)):
        face, rotation, skipped = np.int64(-1), np.int64(0), np.int64(0)
        if encoding:
            face = order[i]
            size = offsets[face + 1] - offsets[face]
            rotation, skipped = _split(within, face, size, rotations[i])
        following = next_left(left, previous + 1)
        step, count, trail = np.int64(NEXT), 0, -1
        if encoding and face != following:
            step = np.int64(ANY)
            corner = anchor_corner(faces, rank, mode, face, rotation)
            anchor = rank[faces[face, corner]]
            trail = trail_of(trails, anchor, m - i, margin) if anchor >= 0 else -1
            if trail >= 0:
                count = _at_anchor(rings, faces, rank, mode, at[anchor], found)
                step = np.int64(NEAR) if index_of(found, count, 3 * face + corner) >= 0 else step
        follows = _shared(faces, following, recent[0])
        step = code_step(c, step, memory, trails, follows, ranked > 0)
        if step == NEXT:
            face = following
        elif step == NEAR:
            corner, anchor = np.int64(0), np.int64(0)
            if encoding:
                corner = anchor_corner(faces, rank, mode, face, rotation)
                anchor = rank[faces[face, corner]]
            anchor = code_anchor(c, anchor, trail, memory, trails, known, value)
            if not 0 <= anchor < ranked:
                return CORRUPT
            count = _at_anchor(rings, faces, rank, mode, at[anchor], found)
            if count == 0:
                return CORRUPT
            chosen = _choose_face(
                c, memory, faces, rank, mode, recent, found, count, 3 * face + corner
            )
            face = chosen // 3
            if mode == FIRST:
                rotation = chosen % 3
        else:
            face = code_any(c, left, face, m - i)
        if step != NEAR or mode != FIRST:
            rotation = code_rotation(c, faces, rank, mode, recent, rotated, face, rotation)
        first, size = offsets[face], offsets[face + 1] - offsets[face]
        begin = within[face, rotation]
        gap = (within[face, (rotation + 1) % 3] - begin) % size
        if gap > 1:
            begin += code_skipped(c, corners, first, size, rank, recent, skips, begin, gap, skipped)
        order[i], rotations[i] = face, begin % size
        remove(left, face)
        recent[1] = recent[0]
        for j in range(3):
            leave_ring(rings, faces[face, j], 3 * face + j)
        for j in range(size):
            v = corners[first + (begin + j) % size]
            if j < 3:
                recent[0, j] = v
            if rank[v] < 0:
                rank[v], at[ranked] = ranked, v
                ranked += 1
        follow(trails, rank[faces[face, anchor_corner(faces, rank, mode, face, rotation)]])
        previous = face
    return OK


@inlined
def _split(within: Ints, face: Int, size: Int, begin: Int) -> tuple[Int, Int]:
    """Return the last corner of a triangle up to a corner of its polygon, and how far that is."""
    rotation, least = np.int64(0), size
    for j in range(3):
        distance = (begin - within[face, j]) % size
        if distance < least:
            rotation, least = np.int64(j), distance
    return rotation, least


@kernel
def _at_anchor(rings: Rings, faces: Ints, rank: Ints, mode: Int, hub: Int, found: Ints) -> Int:
    """Find the corners at `hub` of faces that are left and have it for an anchor."""
    count, e = 0, rings.start[hub]
    for _ in range(SCANNED):
        if e < 0 or count == CANDIDATES:
            break
        if mode == FIRST or anchor_corner(faces, rank, mode, e // 3, np.int64(0)) == e % 3:
            found[count] = e
            count += 1
        e = rings.after[e]
        if e == rings.start[hub]:
            break
    return count


@inlined
def _shared(faces: Ints, face: Int, others: Ints) -> Int:
    """Return how many corners of a face are among three vertices."""
    count = 0
    for j in range(3):
        v = faces[face, j]
        count += 1 if (v == others[0] or v == others[1] or v == others[2]) else 0
    return count


@kernel
def _choose_face(
    c: Coder,
    memory: Ints,
    faces: Ints,
    rank: Ints,
    mode: Int,
    recent: Ints,
    found: Ints,
    count: Int,
    corner: Int,
) -> Int:
    """Code which of the corners found is meant, one bit for each but the last."""
    state = c.state
    for k in range(count):
        face, j = found[k] // 3, found[k] % 3
        shared, before = _shared(faces, face, recent[0]), _shared(faces, face, recent[1])
        a = rank[faces[face, j]]
        b, d = (
            rank_of(rank, faces[face, (j + 1) % 3]),
            rank_of(rank, faces[face, (j + 2) % 3]),
        )
        fresh = (1 if b > a + LARGEST_RANK else 0) + (1 if d > a + LARGEST_RANK else 0)
        alike = _like(rank, recent[0], a, b, d) + 2 * _like(rank, recent[1], a, b, d)
        third = b if (b < d) == (mode == NEWEST) else d
        lead = near(third, memory[CHOICE]) if third < LARGEST_RANK else np.int64(6)
        at = min(k, 3)
        if k < count - 1:
            state[CONTEXT] = CHOOSE + 12 * shared + 3 * before + fresh
            state[CONTEXT + 1] = CHOOSE + CHOOSE_SIZE + 12 * lead + 3 * shared + fresh
            state[CONTEXT + 2] = CHOOSE + 2 * CHOOSE_SIZE + 16 * lead + 4 * alike + at
            if code_bit(c, 1 if found[k] == corner else 0, np.int64(CHOOSE_MIXER)) == 0:
                continue
        memory[CHOICE] = min(third, np.int64(LARGEST_RANK))
        return found[k]
    return np.int64(-1)


@inlined
def _like(rank: Ints, others: Ints, a: Int, b: Int, d: Int) -> Int:
    """Return 1 if ranks differ as those of an earlier face do, from some corner of it; else 0."""
    result = 0
    for j in range(3):
        if others[j] >= 0:
            e = rank[others[j]]
            f, g = rank[others[(j + 1) % 3]], rank[others[(j + 2) % 3]]
            if f - e == b - a and g - e == d - a:
                result = 1
    return result
