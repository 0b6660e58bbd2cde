"""Cuts of a triangle complex along edges, until it is an oriented manifold."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.jit import Flag, Int, inlined, kernel
from deltamesh._kernels.mesh.halfedges import next_halfedge, previous_halfedge
from deltamesh_formats.array_types import Bools, Ints


@inlined
def _find(parent: Ints, reversed_: Bools, f: Int) -> tuple[Int, Flag]:
    """Return the root of a face and whether it is reversed against it, halving paths on the way."""
    odd: Flag = False
    while parent[f] != f:
        up = parent[f]
        reversed_[f] ^= reversed_[up]
        parent[f] = parent[up]
        odd ^= reversed_[f]
        f = parent[f]
    return f, odd


@kernel
def orient(first: Ints, second: Ints, twisted: Bools, parent: Ints, reversed_: Bools) -> None:
    """Reverse faces so that as many pairs as possible agree: union-find with parities.

    first, second : int64 (k,), half-edges on one edge; `twisted` where they run the same way.
    parent : int64 (m,), ends as the root of each face's component.
    reversed_ : bool (m,), at first False, ends as whether to reverse the face: fewer than half of
        each component.
    """
    for k in range(len(first)):
        f, odd = _find(parent, reversed_, first[k] // 3)
        g, other = _find(parent, reversed_, second[k] // 3)
        if f != g:
            low, high = min(f, g), max(f, g)  # the root is the first face of its component
            parent[high] = low
            reversed_[high] = odd ^ other ^ twisted[k]
    size = np.zeros(len(parent), np.int64)
    against = np.zeros(len(parent), np.int64)
    for f in range(len(parent)):
        root, odd = _find(parent, reversed_, f)
        parent[f] = root
        reversed_[f] = odd
        size[root] += 1
        against[root] += odd
    for f in range(len(parent)):
        reversed_[f] ^= 2 * against[parent[f]] > size[parent[f]]


@kernel
def pair_up(order: Ints, bounds: Ints, forward: Bools, component: Ints, opposite: Ints) -> None:
    """Pair half-edges of edges with many faces: those of one component, then across components.

    order : int64, half-edges by edge and by component; edge i has those from bounds[i] on.
    forward : bool (3 m,), component : int64 (m,)
    opposite : int64 (3 m,), filled in.
    """
    waiting = np.empty((2, len(order)), np.int64)
    for i in range(len(bounds) - 1):
        for across in range(2):
            count = np.zeros(2, np.int64)
            last = np.int64(-1)
            for at in range(bounds[i], bounds[i + 1]):
                h = order[at]
                if opposite[h] >= 0:
                    continue
                if across == 0 and component[h // 3] != last:
                    count[:] = 0
                    last = component[h // 3]
                along = 1 if forward[h] else 0
                if count[1 - along] > 0:
                    count[1 - along] -= 1
                    g = waiting[1 - along, count[1 - along]]
                    opposite[h], opposite[g] = g, h
                else:
                    waiting[along, count[along]] = h
                    count[along] += 1


@kernel
def label_fans(opposite: Ints, label: Ints) -> Int:
    """Label the fans of corners in the order of first corners; return how many there are."""
    count = 0
    label[:] = -1
    for h in range(len(opposite)):
        if label[h] >= 0:
            continue
        g: Int = h
        while g >= 0 and label[g] < 0:
            label[g] = count
            g = next_halfedge(opposite[g]) if opposite[g] >= 0 else np.int64(-1)
        g = h if g < 0 else np.int64(-1)
        while g >= 0:
            label[g] = count
            g = opposite[previous_halfedge(g)]
        count += 1
    return count


@inlined
def _first_of_fan(opposite: Ints, h: Int) -> Int:
    """Return the corner at which the fan of a corner begins, itself if the fan is closed."""
    g = h
    while opposite[previous_halfedge(g)] >= 0:
        g = opposite[previous_halfedge(g)]
        if g == h:
            break
    return g


@kernel
def break_slits(opposite: Ints, label: Ints, count: Int) -> None:
    """Cut fans that meet a neighbour twice, as at both sides of a slit, into runs that do not.

    A manifold of triangles may have one edge only between two of its vertices.
    """
    seen = np.full(count + len(opposite), -1, np.int64)
    done = np.zeros(len(opposite), np.bool_)  # not by label: cuts split further fans, too
    run, fresh = 0, count
    for h in range(len(opposite)):
        if done[h]:
            continue
        first = _first_of_fan(opposite, h)
        closed = opposite[previous_halfedge(first)] >= 0
        run += 1
        cuts = 0
        c = first
        seen[label[previous_halfedge(c)]] = run
        while True:
            done[c] = True
            after = next_halfedge(opposite[c]) if opposite[c] >= 0 else np.int64(-1)
            out = label[next_halfedge(c)]
            ends = closed and after == first and cuts == 0  # the spoke that it began with
            if seen[out] == run and not ends:
                before = previous_halfedge(c)
                opposite[opposite[before]] = -1
                opposite[before] = -1
                cuts += 1
                run += 1
                fresh += 1
                seen[label[before]] = run
            seen[out] = run
            if cuts > 0:
                label[c] = fresh - 1  # its neighbours can distinguish this run from the others
            if after < 0 or after == first:
                break
            c = after
        before = previous_halfedge(first)
        if cuts > 0 and opposite[before] >= 0:
            opposite[opposite[before]] = -1
            opposite[before] = -1
