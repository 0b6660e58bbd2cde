"""Slow, obvious twins of what interpolated anchors need: dense matrices, loops over everything."""

from __future__ import annotations

import numpy as np


def neighbours_in(matrix, v):
    return [w for w in np.flatnonzero(matrix[v]).tolist() if w != v]


def nearest(matrix, sources):
    """The place among the sources of the one that a search from all of them reaches each from."""
    found, queue = [-1] * len(matrix), list(sources)
    for place, v in enumerate(sources):
        found[v] = place
    for v in queue:
        for w in neighbours_in(matrix, v):
            if found[w] < 0:
                found[w] = found[v]
                queue.append(w)
    return found


def smoothed(matrix, x, rounds):
    """Half of what each vertex has goes to its neighbours, again and again."""
    for _ in range(rounds):
        after = np.zeros_like(x)
        for v in range(len(matrix)):
            around = neighbours_in(matrix, v)
            after[v] += x[v] / 2 if around else x[v]
            for w in around:
                after[w] += x[v] / 2 / len(around)
        x = after
    return x


def within_blocks(rows, block):
    """The neighbours of each node that are in the same block of so many."""
    return [[w for w in around if w // block == v // block] for v, around in enumerate(rows)]


def cycled(matrix, of, count, b, block, correction=1.7):
    """The cycle of two levels, for a dense matrix of free nodes and any b.

    Gauss and Seidel within blocks, from zero; what the coarse level makes of the residual, times
    the correction; and the same sweep, backward.
    """
    n = len(matrix)
    same = np.arange(n)[:, None] // block == np.arange(n) // block
    lower, upper = np.tril(matrix) * same, np.triu(matrix) * same
    x = np.linalg.solve(lower, b)
    if count:
        coarse = coarsened(matrix, of, count)
        spread = indicators(of, count)
        x = x + correction * spread @ np.linalg.solve(coarse, spread.T @ (b - matrix @ x))
    return x + np.linalg.solve(upper, b - matrix @ x)


def descended(matrix, of, count, b, x, block, most):
    """Conjugate gradients from x, preconditioned by `cycled`, each column for itself."""
    r, p, before = b - matrix @ x, np.zeros_like(x), None
    for _ in range(most):
        z = cycled(matrix, of, count, r, block)
        now = (r * z).sum(axis=0)
        p = z if before is None else z + now / before * p
        q = matrix @ p
        a = now / (p * q).sum(axis=0)
        x, r, before = x + a * p, r - a * q, now
    return x


def aggregates(rows, free):
    """Which aggregate each node is in, and how many there are.

    First each free node with no neighbour in one and a free neighbour makes one of itself and all
    of these; then those left go where the first of their neighbours is that is in one so far.
    """
    found, count = {}, 0
    for v, around in enumerate(rows):
        others = [w for w in around if free[w]]
        if free[v] and v not in found and others and not any(w in found for w in around):
            found |= dict.fromkeys([v, *others], count)
            count += 1
    first = dict(found)
    for v, around in enumerate(rows):
        near = [first[w] for w in around if w in first]
        if free[v] and v not in first and near:
            found[v] = near[0]
    return [found.get(v, -1) for v in range(len(rows))], count


def coarsened(matrix, of, count):
    """P^T A P, with a column of P for each aggregate."""
    spread = indicators(of, count)
    return spread.T @ matrix @ spread


def indicators(of, count):
    """P: which nodes are in each aggregate."""
    found = np.zeros((len(of), count))
    for v, k in enumerate(of):
        if k >= 0:
            found[v, k] = 1
    return found


def factor(matrix):
    """Cholesky's factor, column by column."""
    L = np.zeros_like(matrix)
    for j in range(len(matrix)):
        L[j, j] = np.sqrt(matrix[j, j] - L[j, :j] @ L[j, :j])
        for i in range(j + 1, len(matrix)):
            L[i, j] = (matrix[i, j] - L[i, :j] @ L[j, :j]) / L[j, j]
    return L


def parts(matrix):
    """The vertices of each component, ascending."""
    left, found = set(range(len(matrix))), []
    while left:
        reached = np.array(nearest(matrix, [min(left)])) >= 0
        found.append(np.flatnonzero(reached))
        left -= set(found[-1].tolist())
    return found


def vectors(matrix, anchors, integers, unit, steps):
    """The y of each anchor's cell (SPEC.md 5.20), from integers, the unit, and steps (n, 1)."""
    of, whole, rows = nearest(matrix, anchors), parts(matrix), iter(integers)
    y = np.zeros((len(anchors), 3))
    for k, a in enumerate(anchors):
        own = next(part for part in whole if a in part)
        if len(set(own.tolist()) & set(anchors)) > 1:
            y[k] = 2.0**unit * steps[a] * next(rows) / of.count(k)
    assert next(rows, None) is None
    return y


def completed(matrix, anchors, delta, y):
    """Delta and the y of each cell, less the mean of both over the component."""
    d = delta + y[nearest(matrix, anchors)]
    for part in parts(matrix):
        d[part] -= d[part].mean(axis=0)
    return d


def solution(matrix, anchors, delta, positions):
    """Positions through the anchors, with this Laplacian elsewhere; by component, dense."""
    x = np.zeros_like(delta)
    for part in parts(matrix):
        own = [i for i, a in enumerate(anchors) if a in part]
        held, centre = np.array(anchors)[own], positions[own].mean(axis=0)
        x[held] = positions[own] - centre
        free = np.setdiff1d(part, held)
        right = delta[free] - matrix[np.ix_(free, held)] @ x[held]
        x[free] = np.linalg.solve(matrix[np.ix_(free, free)], right)
        x[part] += centre
    return x
