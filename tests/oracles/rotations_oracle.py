"""Slow, obvious twins of rotations: eigenvectors, means over them, and loops over neighbours."""

from __future__ import annotations

import numpy as np

POWER = 2**14
LINE, THIN, COLLAPSED, NOTHING = 2.0**-10, 1e-4, 1e-2, 1e-14


def matrix_of(q):
    """The rotation of a unit quaternion w, x, y, z."""
    w, x, y, z = q
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def form(C):
    """The sum of b . R a, a quadratic form of the quaternion of R, by its values at ten."""
    basis = np.eye(4)
    K = np.diag([np.sum(matrix_of(q) * C) for q in basis])
    for i in range(4):
        for j in range(i):
            between = np.sum(matrix_of((basis[i] + basis[j]) / np.sqrt(2)) * C)
            K[i, j] = K[j, i] = between - (K[i, i] + K[j, j]) / 2
    return K


def mean_rotation(C, a_squares, b_squares):
    """The mean of the rotations of the eigenvectors, by a power of what each is worth."""
    known = np.sqrt(a_squares * b_squares)
    every = known + NOTHING
    ratio = known / (a_squares + b_squares + NOTHING)
    nothing = (COLLAPSED / (COLLAPSED + ratio)) ** 6
    C = (1 - nothing) * C / every
    s = np.linalg.svd(C, compute_uv=False)
    second = np.sqrt((s[0] * s[1]) ** 2 + (s[1] * s[2]) ** 2 + (s[2] * s[0]) ** 2)
    C = C + (LINE * (THIN / (THIN + second)) ** 2 + NOTHING / every + nothing) * np.eye(3)
    values, vectors = np.linalg.eigh(form(C))
    weights = (1 + LINE + values) / (1 + LINE + values[-1])
    weights = np.maximum(weights, 0) ** POWER
    turns = np.array([matrix_of(q) for q in vectors.T])
    return np.tensordot(weights / weights.sum(), turns, 1)


def around(neighbours, i, rings):
    """The vertices up to so many edges away, each as often as there are walks, or rests, to it."""
    found = [i]
    for _ in range(rings):
        found = [w for v in found for w in (v, *neighbours[v])]
    return found


def fit(neighbours, before, after, rings):
    """The rotation of the edges around each vertex, one by one."""
    before, after = (P / (np.ptp(P, axis=0).max() or 1.0) for P in (before, after))
    turns = []
    for i in range(len(before)):
        edges = [(v, w) for v in around(neighbours, i, rings) for w in neighbours[v]]
        a = np.array([before[w] - before[v] for v, w in edges]).reshape(-1, 3)
        b = np.array([after[w] - after[v] for v, w in edges]).reshape(-1, 3)
        turns.append(mean_rotation(b.T @ a, np.sum(a**2), np.sum(b**2)))
    return np.array(turns)


def nearest(matrix):
    """The rotation nearest to a matrix, which takes the axes to its columns."""
    return mean_rotation(matrix, 3.0, np.sum(matrix**2))


def kabsch(C):
    """The rotation of the largest trace with C, by singular values."""
    U, _, V = np.linalg.svd(C)
    return U @ np.diag([1, 1, np.linalg.det(U @ V)]) @ V


def turned(neighbours, V, turns):
    """The sum of (R_i + R_j) (v_i - v_j) / 2 of each vertex."""
    deltas = np.zeros_like(V)
    for i, around_i in enumerate(neighbours):
        for j in around_i:
            deltas[i] += (turns[i] + turns[j]) / 2 @ (V[i] - V[j])
    return deltas
