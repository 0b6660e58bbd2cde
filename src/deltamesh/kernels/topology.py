"""Kernels on half-edges. Half-edge h = 3 f + c runs from F[f, c] to F[f, (c + 1) % 3]."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from deltamesh.kernels.jit import Int, inlined, kernel


@inlined
def next_halfedge(h: Int) -> Int:
    """Return the half-edge that follows in the same face."""
    return h - 2 if h % 3 == 2 else h + 1


@inlined
def previous_halfedge(h: Int) -> Int:
    """Return the half-edge that precedes in the same face."""
    return h + 2 if h % 3 == 0 else h - 1


@kernel
def first_split_vertex(
    faces: NDArray[np.int64], opposite: NDArray[np.int64], valence: NDArray[np.int64]
) -> Int:
    """Return the first vertex whose faces form more than one fan, or -1; the mesh is closed."""
    done = np.zeros(valence.size, dtype=np.bool_)
    for h in range(3 * len(faces)):
        v = faces[h // 3, h % 3]
        if done[v]:
            continue
        done[v] = True
        count = 0
        g = h
        while True:
            count += 1
            g = next_halfedge(opposite[g])
            if g == h or count > valence[v]:
                break
        if count != valence[v]:
            return v
    return -1
