"""Triangles of triangle strips."""

from __future__ import annotations

import numpy as np

from deltamesh_formats.array_types import Ints


def triangles_of_strips(indices: Ints) -> Ints:
    """Return the triangles of strips, int64 (t, 3).

    The winding of every second triangle of a strip is reversed, so that all face the same side.
    Triangles that have a vertex twice only join two strips, and are left out.

    Parameters
    ----------
    indices : int64 (k,)
        Vertex indices from 0; -1 ends a strip.
    """
    if len(indices) < 3:
        return np.empty((0, 3), dtype=np.int64)
    triples = np.stack([indices[:-2], indices[1:-1], indices[2:]], axis=1)
    at = np.arange(len(triples))
    begins = np.maximum.accumulate(np.where(np.append(-1, indices[:-3]) == -1, at, 0))
    odd = (at - begins) % 2 == 1
    triples[odd] = triples[odd][:, [1, 0, 2]]
    a, b, c = triples.T
    real = (triples >= 0).all(axis=1) & (a != b) & (b != c) & (c != a)
    triangles: Ints = triples[real]
    return triangles
