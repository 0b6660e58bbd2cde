"""A bumpy bar, open at both ends, and edits of it."""

from __future__ import annotations

import numpy as np
from rotations_oracle import matrix_of

from deltamesh._geometry.editing import Held
from deltamesh._geometry.rotations import to_quaternions


def bar(around=48, along=110):
    """Vertices and faces of a tube along z, of length 6 and radius 0.7, with bumps."""
    angle = np.arange(around) / around * 2 * np.pi
    angle, z = np.meshgrid(angle, np.linspace(0, 6, along))
    r = 0.7 + 0.05 * np.cos(6 * angle) * np.sin(5 * z)
    vertices = np.stack((r * np.cos(angle), r * np.sin(angle), z), axis=-1).reshape(-1, 3)
    faces = []
    for row in range(along - 1):
        for i in range(around):
            a, b = row * around + i, row * around + (i + 1) % around
            faces += [(a, b, b + around), (a, b + around, a + around)]
    return vertices, np.array(faces)


def turn(axis, degrees):
    """The matrix of a rotation."""
    half = np.radians(degrees) / 2
    return matrix_of(np.concatenate(([np.cos(half)], np.sin(half) * np.array(axis, float))))


# The rotation of the end above z = 5.7, and where its middle goes; None: it stays.
EDITS = {
    "bend": (turn((0, 1, 0), 120), (3.2, 0, 3.4)),
    "twist": (turn((0, 0, 1), 135), None),
}


def held(V, name):
    """One end fixed, the other turned about its middle, which is moved."""
    R, middle = EDITS[name]
    fixed, moved = V[:, 2] < 0.3, V[:, 2] > 5.7
    vertices = np.flatnonzero(fixed | moved)
    at, positions, chosen = V[moved].mean(axis=0), V[vertices].copy(), moved[vertices]
    positions[chosen] = (positions[chosen] - at) @ R.T + (at if middle is None else middle)
    quaternions = np.where(chosen[:, None], to_quaternions(R[None]), (1.0, 0, 0, 0))
    return Held(vertices, positions, quaternions, np.ones(len(vertices), dtype=bool))
