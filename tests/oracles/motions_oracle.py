"""Slow, obvious twins of the motions of anchors: sets of nodes, and matrices for rotations."""

from __future__ import annotations

import numpy as np
from rotations_oracle import matrix_of


def span(edges, n):
    """Which edges, in their order, join two sets of nodes that are not joined yet."""
    sets, kept = [{v} for v in range(n)], []
    for a, b in edges:
        (one,), (other,) = ([s for s in sets if v in s] for v in (a, b))
        kept.append(one is not other)
        if one is not other:
            sets = [s for s in sets if s is not one and s is not other] + [one | other]
    return kept


def walk(neighbours):
    """The nodes of trees, breadth first from the lowest of each, and their parents."""
    order, parents = [], {}
    for first in range(len(neighbours)):
        if first not in parents:
            parents[first] = -1
            level = [first]
            while level:
                order += level
                found = []
                for v in level:
                    for w in neighbours[v]:
                        if w not in parents:
                            parents[w] = v
                            found.append(w)
                level = found
    return order, [parents[v] for v in range(len(neighbours))]


def quaternion_of(m):
    """The unit quaternion of an axis times tan(angle / 4)."""
    length = np.linalg.norm(m)
    angle = 4 * np.arctan(length)
    axis = m / length if length else m
    return np.concatenate(([np.cos(angle / 2)], np.sin(angle / 2) * axis))


def carry(order, parent, rest, step, unit, numbers):
    """Positions, and matrices of the rotations."""
    positions, turns = {}, {}
    for v in order:
        before = np.eye(3) if parent[v] < 0 else turns[parent[v]]
        at = rest[v]
        if parent[v] >= 0:
            at = positions[parent[v]] + before @ (rest[v] - rest[parent[v]])
        positions[v] = at + step * numbers[v][:3]
        turns[v] = matrix_of(quaternion_of(unit * numbers[v][3:])) @ before
    n = range(len(rest))
    return np.array([positions[v] for v in n]), np.array([turns[v] for v in n])
