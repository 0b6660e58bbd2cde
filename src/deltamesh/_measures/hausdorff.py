"""Hausdorff distance of two triangle soups, from samples of one to the surface of the other.

Sources: P. Cignoni, C. Rocchini, R. Scopigno, "Metro: measuring error on simplified surfaces",
Comput. Graph. Forum 17(2), 1998 (samples by area); A. A. Taha, A. Hanbury, "An efficient algorithm
for calculating the exact Hausdorff distance", IEEE TPAMI 37(11), 2015 (early breaking).
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.mesh import closest
from deltamesh_formats.array_types import Floats, Ints

# Samples on a surface besides its vertices: the larger of these.
SAMPLES_PER_FACE = 2
LEAST_SAMPLES = 20_000


def squared_hausdorff(triangles: Floats, others: Floats) -> float:
    """Return the largest squared distance from samples of either surface to the other surface.

    Parameters
    ----------
    triangles, others : float64 (m, 3, 3), (l, 3, 3)
        Corners of the triangles, of about unit size; m, l > 0.
    """
    largest = _one_sided(triangles, others, 0.0)
    return _one_sided(others, triangles, largest)


def _one_sided(triangles: Floats, others: Floats, largest: float) -> float:
    """Return the largest squared distance of `triangles` from `others`, at least `largest`."""
    face, barycentric = _surface_samples(triangles)
    at = np.arange(len(triangles))
    corners = np.eye(3)
    # Where the faces correspond, the same point of the same face bounds the distance from above.
    face = np.concatenate((face, at, at, at))
    barycentric = np.concatenate((barycentric, np.repeat(corners, len(triangles), axis=0)))
    points = np.einsum("sc,scd->sd", barycentric, triangles[face])
    if triangles.shape == others.shape:
        bounds = ((points - np.einsum("sc,scd->sd", barycentric, others[face])) ** 2).sum(axis=1)
    else:
        bounds = np.full(len(points), np.inf)
    # Far points first: the largest distance is known early, and the others need no search.
    order = np.argsort(-bounds, kind="stable")
    leaves = 1 << ((len(others) - 1) // closest.LEAF).bit_length()
    others = others[_tree_order(others.mean(axis=1), leaves)]
    low, high = np.empty((2 * leaves - 1, 3)), np.empty((2 * leaves - 1, 3))
    closest.fill_boxes(others, low, high)
    return closest.largest_squared_distance(
        points[order], bounds[order], others, low, high, largest
    )


def _surface_samples(triangles: Floats) -> tuple[Ints, Floats]:
    """Return faces (s,) and barycentric coordinates (s, 3) of points spread evenly over the area.

    Systematic sampling by cumulated area; within the faces the additive recurrence R2 (M. Roberts,
    "The unreasonable effectiveness of quasirandom sequences", 2018), folded into the triangle.
    """
    area = np.linalg.norm(
        np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]), axis=1
    )
    cumulated = np.cumsum(area)
    if not cumulated[-1] > 0:
        return np.empty(0, dtype=np.int64), np.empty((0, 3))
    count = max(SAMPLES_PER_FACE * len(triangles), LEAST_SAMPLES)
    i = np.arange(count)
    face = np.searchsorted(cumulated, (i + 0.5) / count * cumulated[-1])
    plastic = 1.32471795724474602596  # x^3 = x + 1
    u, v = (0.5 + i / plastic) % 1.0, (0.5 + i / plastic**2) % 1.0
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return face, np.stack((1 - u - v, u, v), axis=1)


def _tree_order(points: Floats, leaves: int) -> Ints:
    """Return the order of points (m, 3) in a tree that halves each box along its longest side.

    Every level sorts all of its boxes at once, as `mesh.closest` does.
    """
    order = np.arange(len(points))
    size = leaves * closest.LEAF
    while size > closest.LEAF:
        x, box = points[order], np.arange(len(points)) // size
        starts = np.arange(0, len(points), size)
        low, extent = np.minimum.reduceat(x, starts), np.maximum.reduceat(x, starts)
        extent -= low
        axis = np.argmax(extent, axis=1)
        at = np.arange(len(starts))
        scale = 0.5 / np.maximum(extent[at, axis], 1e-300)  # below 1: boxes stay apart
        along = (x[np.arange(len(x)), axis[box]] - low[at, axis][box]) * scale[box]
        order = order[np.argsort(box + along)]
        size //= 2
    return order
