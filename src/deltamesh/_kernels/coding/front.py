"""Fronts of a region that grows over a closed triangle mesh.

A *node* is one appearance of a vertex on a front. Its *free* edges are those of its vertex inside
the unvisited region that the node borders on. The *gate* from a node to its successor is an edge
of the front, with the unvisited region on its left. All fronts are circular lists over one set of
nodes, so that one operation on four links splits a front or merges two (see `connectivity`).

Nodes wait in buckets by their free edges, and choosing a pivot takes constant time. The oldest of
a bucket comes first: the front then stays round, which halves the joins that the newest makes.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from deltamesh._kernels.jit import Int, inlined
from deltamesh_formats.array_types import Ints

BUCKETS = 64  # nodes with more free edges share the last one; they are rarely the lowest

# Indices into Front.counts: so far; on a front now; a lower bound of the lowest bucket in use; then
# the oldest node of each bucket, and the newest, -1: none.
NODES, VERTICES, FACES, JOINS, LIVE, LOWEST, OLDEST = range(7)
NEWEST = OLDEST + BUCKETS

NODE = np.dtype(
    [
        ("vertex", np.int64),
        ("free", np.int64),
        ("successor", np.int64),  # the neighbours on the front
        ("predecessor", np.int64),
        ("behind", np.int64),  # the vertex of the visited face at the gate that is not on it
        ("gate", np.int64),  # the half-edge of the unvisited face at the gate; encoder only
        ("older", np.int64),  # the neighbours in the bucket
        ("newer", np.int64),
        ("index", np.int64),  # in Front.live
    ]
)


class Front(NamedTuple):
    """All fronts.

    Attributes
    ----------
    nodes : NODE (capacity,)
    live : int64 (capacity,)
        The nodes that are on a front, in no order.
    counts : int64 (NEWEST + BUCKETS,)
    """

    nodes: Any
    live: Ints
    counts: Ints


def new_front(capacity: Int) -> Front:
    """Return an empty front for at most `capacity` nodes."""
    counts = np.zeros(NEWEST + BUCKETS, dtype=np.int64)
    counts[LOWEST], counts[OLDEST:] = BUCKETS, -1
    return Front(np.empty(capacity, dtype=NODE), np.empty(capacity, dtype=np.int64), counts)


@inlined
def _enqueue(front: Front, node: Int) -> None:
    nodes = front.nodes
    counts = front.counts
    b = min(nodes[node].free, BUCKETS - 1)
    last = counts[NEWEST + b]
    nodes[node].older = last
    nodes[node].newer = -1
    if last >= 0:
        nodes[last].newer = node
    else:
        counts[OLDEST + b] = node
    counts[NEWEST + b] = node
    counts[LOWEST] = min(counts[LOWEST], b)


@inlined
def _dequeue(front: Front, node: Int) -> None:
    nodes = front.nodes
    counts = front.counts
    older, newer = nodes[node].older, nodes[node].newer
    b = min(nodes[node].free, BUCKETS - 1)
    if older >= 0:
        nodes[older].newer = newer
    else:
        counts[OLDEST + b] = newer
    if newer >= 0:
        nodes[newer].older = older
    else:
        counts[NEWEST + b] = older


@inlined
def add_node(front: Front, vertex: Int, free: Int) -> Int:
    """Make a new live node; the caller links it."""
    nodes = front.nodes
    counts = front.counts
    node = counts[NODES]
    counts[NODES] = node + 1
    index = counts[LIVE]
    counts[LIVE] = index + 1
    front.live[index] = node
    nodes[node].vertex = vertex
    nodes[node].free = free
    nodes[node].index = index
    _enqueue(front, node)
    return node


@inlined
def remove_node(front: Front, node: Int) -> None:
    """Take a node off the buckets and the live nodes; the caller mends the front."""
    counts = front.counts
    _dequeue(front, node)
    counts[LIVE] -= 1
    last, index = front.live[counts[LIVE]], front.nodes[node].index
    front.live[index] = last
    front.nodes[last].index = index


@inlined
def set_free(front: Front, node: Int, free: Int) -> None:
    """Change the number of free edges of a node."""
    _dequeue(front, node)
    front.nodes[node].free = free
    _enqueue(front, node)


@inlined
def link(front: Front, a: Int, b: Int, behind: Int, gate: Int) -> None:
    """Make b the successor of a, with the vertex behind the gate and the half-edge at it."""
    nodes = front.nodes
    nodes[a].successor = b
    nodes[b].predecessor = a
    nodes[a].behind = behind
    nodes[a].gate = gate


@inlined
def choose_pivot(front: Front) -> Int:
    """Return the oldest node with the fewest free edges, -1 when all fronts are closed."""
    counts = front.counts
    b = counts[LOWEST]
    while b < BUCKETS and counts[OLDEST + b] < 0:
        b += 1
    counts[LOWEST] = b
    return counts[OLDEST + b] if b < BUCKETS else -1
