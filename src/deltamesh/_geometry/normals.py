"""Vertex normals of a reconstructed surface."""

from __future__ import annotations

import numpy as np

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
    extent = (float(np.ptp(V, axis=0).max()) if len(V) else 0.0) or 1.0
    V = (V - V[:1]) / extent  # products of coordinates then neither overflow nor vanish
    a, b, c = V[F[:, 0]], V[F[:, 1]], V[F[:, 2]]
    cross = np.cross(b - a, c - a)
    area = np.linalg.norm(cross, axis=1)
    corners = F.T.ravel()
    s = np.stack([_gather(corners, np.tile(cross[:, k], 3), len(V)) for k in range(3)], axis=1)
    with np.errstate(over="ignore"):
        steps = np.minimum(np.ravel(step) / extent, MOST_STEP)
    around = _gather(corners, np.tile(area, 3), len(V)) + steps**2
    normals: Floats = s / (np.linalg.norm(s, axis=1) + FADE * around)[:, None]
    return normals


def _gather(corners: Ints, values: Floats, n: int) -> Floats:
    return np.bincount(corners, weights=values, minlength=n).astype(np.float64)
