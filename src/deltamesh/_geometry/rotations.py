"""Rotations of a surface: how the neighbourhood of each vertex turns, and deltas that turn with it.

Source: Y. Lipman, O. Sorkine, D. Levin, D. Cohen-Or, "Linear rotation-invariant coordinates for
meshes", SIGGRAPH 2005; O. Sorkine, M. Alexa, "As-rigid-as-possible surface modeling", SGP 2007.
"""

from __future__ import annotations

from typing import Final

import numpy as np

from deltamesh._graph.adjacency import Graph
from deltamesh._kernels.mesh import rotations as kernels
from deltamesh_formats.array_types import Floats

# The square of a quaternion's length that stands for no rotation; a unit one does not notice.
NONE: Final = 2.0**-40


def fit(graph: Graph, before: Floats, after: Floats, rings: int = 0) -> Floats:
    """Return the rotations that best take the edges of one surface to those of another.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
        Neighbour lists, from `adjacency.adjacency`.
    before, after : float64 (n, 3)
        Vertices of both surfaces, finite.
    rings : int
        The sums of products of edges are those of the vertices up to so many edges away, which
        makes the rotations smoother.

    Returns
    -------
    float64 (n, 3, 3)
        Matrices R: R (a_j - a_i) is near b_j - b_i, for the neighbours j of vertex i. The identity
        where all edges have no length, or there are none. Where edges determine no single rotation
        (all along one line, or mirrored), the matrix is a mean of those that are equally good, no
        rotation then; across one line it is the identity, as far as the line does not turn about.

    Notes
    -----
    Noise in the vertices, in extents, comes back in deltas that are turned by these matrices, ten
    times as large on common surfaces, where the Laplacian alone does as much, and 2^14 times where
    neighbourhoods have nearly collapsed or are mirrored, so that all rotations are equally bad.
    """
    return kernels.fit(*graph, _plain(before), _plain(after), rings)


def nearest(matrices: Floats) -> Floats:
    """Return the rotation that is nearest to each matrix, float64 (n, 3, 3).

    Parameters
    ----------
    matrices : float64 (n, 3, 3)
        Of about the size of rotations: the identity is nearest to zero.
    """
    return kernels.nearest(_plain(matrices))


def of_quaternions(quaternions: Floats) -> Floats:
    """Return the rotations of quaternions of any length, the identity of no length.

    Parameters
    ----------
    quaternions : float64 (n, 4)
        w, x, y, z.

    Returns
    -------
    float64 (n, 3, 3)
    """
    w, x, y, z = np.ascontiguousarray(quaternions, dtype=np.float64).T
    rows = (
        *(w * w + x * x - y * y - z * z + NONE, 2 * (x * y - w * z), 2 * (x * z + w * y)),
        *(2 * (x * y + w * z), w * w - x * x + y * y - z * z + NONE, 2 * (y * z - w * x)),
        *(2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z + NONE),
    )
    matrices: Floats = np.stack(rows, axis=1) / (w * w + x * x + y * y + z * z + NONE)[:, None]
    return matrices.reshape(-1, 3, 3)


def to_quaternions(matrices: Floats) -> Floats:
    """Return the unit quaternions of rotations, float64 (n, 4), w first and not negative.

    Parameters
    ----------
    matrices : float64 (n, 3, 3)
    """
    (a, b, c), (d, e, f), (g, h, i) = np.moveaxis(_plain(matrices), 0, 2)
    products = np.empty((len(matrices), 4, 4))  # of components, four times
    products[:, 0, 0], products[:, 1, 1] = 1 + a + e + i, 1 + a - e - i
    products[:, 2, 2], products[:, 3, 3] = 1 - a + e - i, 1 - a - e + i
    products[:, 0, 1] = products[:, 1, 0] = h - f
    products[:, 0, 2] = products[:, 2, 0] = c - g
    products[:, 0, 3] = products[:, 3, 0] = d - b
    products[:, 1, 2] = products[:, 2, 1] = b + d
    products[:, 1, 3] = products[:, 3, 1] = c + g
    products[:, 2, 3] = products[:, 3, 2] = f + h
    largest = np.einsum("nii->ni", products).argmax(axis=1)
    q = products[np.arange(len(products)), largest]
    lengths = np.sqrt((q * q).sum(axis=1, keepdims=True))
    return np.asarray(np.where(q[:, :1] < 0, -q, q) / lengths)


def turned_deltas(graph: Graph, vertices: Floats, matrices: Floats) -> Floats:
    """Return the sums of (R_i + R_j) (v_i - v_j) / 2 over the neighbours j of each vertex i.

    They are the deltas that the surface has where its neighbourhoods have turned: exactly where
    all have turned alike, and otherwise as far as edges turn like the mean of their ends.

    Parameters
    ----------
    graph : pair of int32 arrays (n + 1,), (2 e,)
    vertices : float64 (n, 3)
    matrices : float64 (n, 3, 3)
        Of `fit` or `nearest`, say.

    Returns
    -------
    float64 (n, 3)
    """
    return kernels.turned_deltas(*graph, _plain(vertices), _plain(matrices))


def _plain(array: Floats) -> Floats:
    return np.ascontiguousarray(array, dtype=np.float64)
