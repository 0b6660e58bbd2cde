"""Normals of the vertices of a surface; `src/core/normals.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import call, floats, floats_out, ints
from deltamesh_formats.array_types import Floats, Ints


def vertex_normals(V: Floats, F: Ints, steps: Floats, most: float, fade: float) -> Floats:
    """Return s / (|s| + fade * (a + step^2)) of each vertex, float64 (n, 3), in extents of V.

    s is the sum of the cross products of the faces F (m, 3) around the vertex, and a that of their
    lengths. The steps are those of all vertices, (1,), or of each, (n,), and at most so many
    extents: the longest side of the bounding box, or 1.
    """
    n, m, count = len(V), len(F), len(steps)
    normals, areas = np.empty((n, 3)), np.empty(n)
    surface = floats(V, n, 3), n, ints(F, m, 3), m
    fading = floats(steps, count), count, most, fade
    call("dm_vertex_normals", *surface, *fading, floats_out(normals, n, 3), floats_out(areas, n))
    return normals
