"""Parallelograms of two triangles, or of a quad, each of which predicts its last vertex."""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._graph.halfedges import pair_halfedges
from deltamesh._kernels.mesh import parallelograms as kernels
from deltamesh_formats.array_types import Ints, Shorts

NO_QUADS: Final = np.zeros((0, 4), dtype=np.int64)


def parallelograms(
    faces: Ints,
    n: int,
    quads: Ints = NO_QUADS,
    opposite: Ints | None = None,
) -> tuple[Shorts, Shorts, Shorts]:
    """Return, for each vertex, the parallelograms that predict it.

    Parameters
    ----------
    faces : int64 (m, 3)
        Triangles.
    n : int
        Number of vertices.
    quads : int64 (q, 4)
        The polygons of four corners that are cut into triangles of `faces`.
    opposite : int64 (3 m,), optional
        As `halfedges.pair_halfedges` returns it, where it is known.

    Returns
    -------
    first : int32 (n + 1,)
    corners : int32 (p, 3)
        Rows first[i] to first[i + 1] are (a, b, o), all below i: first those where (a, i, b, o)
        is a quad, then those where (a, b, i) is a triangle, (b, a, o) another.
    within : int32 (n,)
        Number of parallelograms of each vertex that are quads.
    """
    opposite = pair_halfedges(faces) if opposite is None else opposite
    return kernels.find(faces, n, opposite, quads)
