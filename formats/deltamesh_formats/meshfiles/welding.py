"""Merging of vertices at one position, for formats whose triangles have vertices of their own."""

from __future__ import annotations

import numpy as np

from deltamesh_formats.array_types import Floats, Ints
from deltamesh_formats.polymesh.permutations import inverse


def welded(points: Floats) -> tuple[Floats, Ints]:
    """Return the distinct positions by first appearance, (n, 3), and the index of each point."""
    order = np.lexsort(points.T)  # stable, and -0.0 is 0.0
    new = np.ones(len(points), dtype=bool)
    new[1:] = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    first = order[new]
    by_appearance = np.argsort(first)
    index = np.empty(len(points), dtype=np.int64)
    index[order] = inverse(by_appearance)[np.cumsum(new) - 1]
    return points[first[by_appearance]], index
