"""Twins of the kernels of differences: one vertex, one face, one edge at a time."""

from __future__ import annotations

import numpy as np


def distance(v, w, unit):
    """The twin of differences.distances, of one vertex."""
    return np.linalg.norm((w - v) / unit)


def face_normal(V, face, unit):
    """The twin of differences.face_normals, of one face: the normal, and twice the area.

    Each side is divided by its largest number, where it has one.
    """
    a, b, c = V[face]
    left, right = (b - a) / unit, (c - a) / unit
    i, j = (np.abs(side).max() or 1.0 for side in (left, right))
    normal = np.cross(left / i, right / j)
    return normal, np.linalg.norm(normal) * i * j


def angle(a, b):
    """Between two vectors, in degrees."""
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b))


def face_change(before, after, least, most):
    """The twin of differences.face_changes, of one face: the angle, and whether lost or turned."""
    (normal, area), (other, left) = before, after
    between = angle(normal, other) if other.any() else 90.0
    if area > 0 and left < least * area:
        return between, True, False
    return between, False, bool(area > 0 and between > most)


def dihedral_angle(V, left, right, pair, same):
    """The twin of differences.dihedral_angles, of one edge and the normals beside it."""
    right = -right if same else right
    along = V[pair[1]] - V[pair[0]]
    return angle(left, right) * (-1 if np.cross(left, right) @ along < 0 else 1)
