"""Slow, obvious twins of the fast code: Python integers, dense matrices, loops over everything."""

from __future__ import annotations

import itertools

import numpy as np

# ---- Laplacian, anchors, metrics, correspondence --------------------------------------------


def laplacian(faces, n):
    """D - A, entry by entry."""
    matrix = np.zeros((n, n))
    for face in faces:
        for a, b in itertools.permutations(face, 2):
            if a != b:
                matrix[a, b] = -1.0
    return matrix - np.diag(matrix.sum(axis=1))


def least_squares(matrix, anchors, delta, positions):
    """Dense [L; S] x = [delta; c] in the least-squares sense."""
    S = np.eye(len(matrix))[anchors]
    return np.linalg.lstsq(
        np.concatenate((matrix, S)), np.concatenate((delta, positions)), rcond=None
    )[0]


def graph_distances(matrix, sources):
    """Edges from each vertex to the nearest source; n where there is none."""
    n = len(matrix)
    distance, ring, steps = [n] * n, set(sources), 0
    while ring:
        for v in ring:
            distance[v] = steps
        ring = {w for v in ring for w in np.flatnonzero(matrix[v] < 0) if distance[w] == n}
        steps += 1
    return distance


def lowest_of_components(matrix):
    """The vertices that no lower one is connected to."""
    n = len(matrix)
    return [v for v in range(n) if min(graph_distances(matrix, [v])[:v], default=n) == n]


def farthest(matrix, k):
    """Farthest points, all distances from scratch for each of them."""
    anchors = lowest_of_components(matrix)
    while len(anchors) < min(k, len(matrix)):
        anchors.append(int(np.argmax(graph_distances(matrix, anchors))))
    return anchors


def splitmix64(seed, count):
    """The generator as published, in Python integers."""
    mask, state, outputs = 2**64 - 1, seed, []
    for _ in range(count):
        state = (state + 0x9E3779B97F4A7C15) & mask
        z = state
        z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & mask
        z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & mask
        outputs.append(z ^ (z >> 31))
    return outputs


def greedy_errors(matrix, vertices, delta, anchors, positions):
    """Vertex errors of the dense reconstruction from delta and anchors, 0 at the anchors."""
    x = least_squares(matrix, anchors, delta, positions[anchors])
    errors = np.linalg.norm(x - vertices, axis=1)
    errors[anchors] = 0.0
    return errors


def squared_to_triangle(p, triangle):
    """Squared distance by minimizing over the barycentric coordinates of the four cases."""
    best = min(float(((p - corner) ** 2).sum()) for corner in triangle)
    for a, b in itertools.combinations(triangle, 2):
        if (a != b).any():
            t = (p - a) @ (b - a) / ((b - a) @ (b - a))
            if 0 <= t <= 1:
                best = min(best, float(((p - a - t * (b - a)) ** 2).sum()))
    a, edges = triangle[0], (triangle[1:] - triangle[0]).T
    if np.linalg.matrix_rank(edges) == 2:
        s = np.linalg.lstsq(edges, p - a, rcond=None)[0]
        if (s >= 0).all() and s.sum() <= 1:
            best = min(best, float(((p - a - edges @ s) ** 2).sum()))
    return best


def largest_squared_distance(points, triangles):
    """Of each point from its nearest triangle, the largest."""
    return max(min(squared_to_triangle(p, t) for t in triangles) for p in points)


def dihedral_angles(V, faces):
    """Oriented angle in degrees between the normals at each edge of two faces; edge -> angle."""
    around = {}
    for face in faces:
        for a, b in zip(face, np.roll(face, -1), strict=True):
            around.setdefault(frozenset((int(a), int(b))), []).append((face, V[b] - V[a]))
    angles = {}
    for edge, sides in around.items():
        if len(sides) == 2:
            m, k = (np.cross(V[f[1]] - V[f[0]], V[f[2]] - V[f[0]]) for f, _ in sides)
            cosine = m @ k / np.sqrt((m @ m) * (k @ k))
            sign = np.sign(np.cross(m, k) @ sides[0][1])
            angles[edge] = sign * np.degrees(np.arccos(np.clip(cosine, -1, 1)))
    return angles
