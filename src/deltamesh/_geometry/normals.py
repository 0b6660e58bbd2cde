"""Vertex normals of a reconstructed surface."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.mesh import normals as kernels
from deltamesh_formats.array_types import Floats, Ints

# Where the faces around a vertex all but cancel, or have collapsed, a direction would be rounding
# noise, and encoder and decoder would disagree in it: the normal fades to zero below that share of
# the area around the vertex, and of the square of the quantization step, instead.
FADE = 1e-3
# Steps above so many extents of the surface leave no normals, either: the square stays finite.
MOST_STEP = 1e150


def vertex_normals(V: Floats, F: Ints, step: float | Floats) -> Floats:
    """Return the sums of the area-weighted normals of the faces around each vertex, normalized.

    Parameters
    ----------
    V : float64 (n, 3)
    F : int64 (m, 3)
    step : float, or float64 (n, 1)
        The step of the deltas of the surface, of all vertices or of each.

    Returns
    -------
    float64 (n, 3)
        s / (|s| + FADE * (a + step^2)), s the sum of the cross products of the faces and a that of
        their lengths: of length 1, nearly, or less where there is little to go by.
    """
    steps = np.ravel(np.asarray(step, dtype=np.float64))
    return kernels.vertex_normals(V, F, steps, MOST_STEP, FADE)
