"""Stitches of a manifold: vertices at one point, and faces reversed, repeated or degenerate.

Everything is coded in the order of the manifold, in contexts of its connectivity. Where two banks
of a cut run side by side, the mate of a vertex, another vertex at its point, is next to the mate of
its neighbour: the neighbours of the mates of its neighbours are candidates, ranked by how many
neighbours suggest them.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.coding.coder import CONTEXT, Coder, code_bit, code_number
from deltamesh._kernels.coding.models import Model, layout
from deltamesh._kernels.coding.valence import MAX_BITS, code_below
from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh_formats.array_types import Bools, Ints

# Candidates that are kept, and neighbours of neighbours that are looked at: a bound on the work.
CANDIDATES, LOOKS = 16, 256

# Mixers, and the first slot of each of their inputs: its range is indexed by its contexts.
STITCHED, MATCHES, REVERSED, REPEATED, NUMBER, ADJACENT = range(6)
MIXERS = ((3, 255), (2, 255), (3, 255), (2, 255), (1, 255), (1, 255))
(
    STITCHED_BY_LOWER,
    STITCHED_BY_BEFORE,
    STITCHED_BY_VOTES,
    MATCHES_BY_RANK,
    MATCHES_BY_RIVAL,
    REVERSED_BY_BEFORE,
    REVERSED_BY_AROUND,
    REVERSED_BY_BOTH,
    REPEATED_BY_LAST,
    REPEATED_BY_AROUND,
    NUMBER_AT,
    ADJACENT_AT,
    SLOTS,
) = layout(
    (2, 4, 4),
    (2, 4, 2),
    (2, 8, 2),
    (8, 16),
    (8, 8),
    (2, 2),
    (4, 4),
    (4, 4, 4),
    (2, 4, 4),
    (2, 4, 4),
    (MAX_BITS,),
    (1,),
)
MODEL = Model(SLOTS, MIXERS)


@kernel
def code_stitches(c: Coder, indptr: Ints, indices: Ints, boundary: Bools, points: Ints) -> Int:
    """Code `points` (n,), filled in when decoding; return how many there are, -1: corrupt.

    Points are numbered in the order of their first vertices. `boundary` (n,) is whether vertices
    are on a boundary of the manifold; their neighbours are those of `adjacency.adjacency`.
    """
    n = len(points)
    state = c.state
    latest = np.full(n, -1, np.int64)  # of the vertices of each point
    earlier = np.full(n, -1, np.int64)
    beside = np.full(n, -1, np.int64)  # the last vertex that has a neighbour at each point
    flags = np.zeros(n, np.int64)
    candidates, votes = np.empty(CANDIDATES, np.int64), np.empty(CANDIDATES, np.int64)
    count = 0
    for v in range(n):
        lower, stitched = 0, 0
        for at in range(indptr[v], indptr[v + 1]):
            u = indices[at]
            if u >= v:
                break  # neighbours ascend
            lower += 1
            stitched += earlier[latest[points[u]]] >= 0
            beside[points[u]] = v
        found = _find_candidates(
            indptr, indices, boundary, points, latest, earlier, beside, v, candidates, votes
        )
        best = min(votes[0], 7) if found > 0 else 0
        edge = 1 if boundary[v] else 0
        before = flags[v - 1] + 2 * flags[v - 2] if v > 1 else 0
        state[CONTEXT] = STITCHED_BY_LOWER + (edge * 4 + min(stitched, 3)) * 4 + min(lower, 3)
        state[CONTEXT + 1] = STITCHED_BY_BEFORE + (edge * 4 + before) * 2 + min(stitched, 1)
        state[CONTEXT + 2] = STITCHED_BY_VOTES + (edge * 8 + best) * 2 + flags[max(v - 1, 0)]
        flags[v] = code_bit(c, 1 if points[v] < count else 0, np.int64(STITCHED)) if v > 0 else 0
        if flags[v] == 0:
            points[v] = count
            count += 1
        else:
            points[v] = _code_match(c, points[v], count, candidates, votes, found)
            if points[v] < 0 or beside[points[v]] == v:
                return -1
        earlier[v] = latest[points[v]]
        latest[points[v]] = v
    return count


@inlined
def _find_candidates(
    indptr: Ints,
    indices: Ints,
    boundary: Bools,
    points: Ints,
    latest: Ints,
    earlier: Ints,
    beside: Ints,
    v: Int,
    candidates: Ints,
    votes: Ints,
) -> Int:
    """Find the points that a vertex may be at, in the order of their votes; return how many."""
    found, looks = 0, 0
    for at in range(indptr[v], indptr[v + 1]):
        u = indices[at]
        if u >= v:
            break
        mate = latest[points[u]]
        while mate >= 0 and looks < LOOKS:
            looks += 1
            for by in range(indptr[mate], indptr[mate + 1]):
                w = indices[by]
                if w >= v or looks == LOOKS:
                    break
                looks += 1
                point = points[w]
                slit = boundary[u] and boundary[v] and boundary[w]
                if beside[point] == v or (mate == u and not slit):
                    continue
                k = 0
                while k < found and candidates[k] != point:
                    k += 1
                if k == CANDIDATES:
                    continue
                if k == found:
                    candidates[k], votes[k] = point, 0
                    found += 1
                votes[k] += 2 if boundary[w] == boundary[v] else 1
                while k > 0 and votes[k - 1] < votes[k]:
                    candidates[k], candidates[k - 1] = candidates[k - 1], candidates[k]
                    votes[k], votes[k - 1] = votes[k - 1], votes[k]
                    k -= 1
            mate = earlier[mate]
    return found


@inlined
def _code_match(c: Coder, point: Int, count: Int, candidates: Ints, votes: Ints, found: Int) -> Int:
    """Code the point of a vertex, one of those so far; -1: a candidate that was skipped before."""
    for k in range(found):
        rank, vote = min(k, 7), min(votes[k], 15)
        rival = min(votes[k + 1], 7) if k + 1 < found else 0
        c.state[CONTEXT] = MATCHES_BY_RANK + rank * 16 + vote
        c.state[CONTEXT + 1] = MATCHES_BY_RIVAL + min(vote, 7) * 8 + rival
        if code_bit(c, 1 if candidates[k] == point else 0, np.int64(MATCHES)) == 1:
            return candidates[k]
    point = code_below(c, point, count)
    for k in range(found):
        if candidates[k] == point:
            return np.int64(-1)
    return point


@kernel
def code_reversed(c: Coder, opposite: Ints, reversed_: Bools) -> None:
    """Code which faces (m,) are reversed, filled in when decoding."""
    state = c.state
    for f in range(len(reversed_)):
        known, around = 0, 0
        for h in range(3 * f, 3 * f + 3):
            g = opposite[h] // 3
            if 0 <= g < f:
                known += 1
                around += reversed_[g]
        last = 1 if f > 0 and reversed_[f - 1] else 0
        before = 1 if f > 1 and reversed_[f - 2] else 0
        state[CONTEXT] = REVERSED_BY_BEFORE + 2 * last + before
        state[CONTEXT + 1] = REVERSED_BY_AROUND + 4 * known + around
        state[CONTEXT + 2] = REVERSED_BY_BOTH + 4 * (4 * known + around) + 2 * last + before
        reversed_[f] = code_bit(c, 1 if reversed_[f] else 0, np.int64(REVERSED)) == 1


@kernel
def code_repeats(c: Coder, opposite: Ints, repeats: Ints, total: Int) -> Flag:
    """Code how often each face is repeated, `repeats` (m, 2): in its winding, in the opposite one.

    Filled in when decoding; return whether the sum is the total.
    """
    state = c.state
    rest = total
    for f in range(len(repeats)):
        for winding in range(2):
            around = 0
            for h in range(3 * f, 3 * f + 3):
                g = opposite[h] // 3
                if 0 <= g < f:
                    around = max(around, repeats[g, winding])
            last = repeats[f - 1, winding] if f > 0 else 0
            number, k = repeats[f, winding], 0
            while rest > 0:
                level = winding * 4 + min(k, 3)
                state[CONTEXT] = REPEATED_BY_LAST + 4 * level + min(last, 3)
                state[CONTEXT + 1] = REPEATED_BY_AROUND + 4 * level + min(around, 3)
                if code_bit(c, 1 if number > k else 0, np.int64(REPEATED)) == 0:
                    break
                k += 1
                rest -= 1
            repeats[f, winding] = k
    return rest == 0


@kernel
def code_degenerate(c: Coder, indptr: Ints, indices: Ints, pairs: Ints, n: Int) -> Flag:
    """Code faces (a, a, b) as `pairs` (d, 2) of a and b, in ascending order of a.

    Filled in when decoding; return whether they ascend below n, the number of points, of which
    those of the graph come first.
    """
    a, last = np.int64(0), np.int64(-1)
    for k in range(len(pairs)):
        more = code_number(
            c, pairs[k, 0] - a + 1, np.int64(NUMBER_AT), np.int64(NUMBER), np.int64(MAX_BITS)
        )
        a += more - 1
        if a < 0 or a >= n:
            return False
        first = indptr[min(a, len(indptr) - 1)]
        valence = indptr[a + 1] - first if a + 1 < len(indptr) else 0
        index = _find(indices, first, valence, pairs[k, 1])
        b = pairs[k, 1]
        adjacent = np.int64(0)
        if valence > 0:
            c.state[CONTEXT] = ADJACENT_AT
            adjacent = code_bit(c, 1 if index >= 0 else 0, np.int64(ADJACENT))
        if adjacent == 1:
            b = indices[first + code_below(c, index, valence)]
        else:
            b = code_below(c, b, n)
            if _find(indices, first, valence, b) >= 0:
                return False
        if more == 1 and b < last:
            return False
        last = b
        pairs[k, 0], pairs[k, 1] = a, b
    return True


@inlined
def _find(indices: Ints, first: Int, valence: Int, vertex: Int) -> Int:
    """Return the index of a vertex among the neighbours from `first` on, -1 if it is none."""
    low, high = np.int64(0), np.int64(valence)
    while low < high:
        middle = (low + high) // 2
        if indices[first + middle] < vertex:
            low = middle + 1
        else:
            high = middle
    return low if low < valence and indices[first + low] == vertex else np.int64(-1)
