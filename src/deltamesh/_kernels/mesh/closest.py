"""Distance from points to a triangle mesh, by a tree of bounding boxes.

The tree is a complete binary one over the triangles in spatial order: node i has children 2 i + 1
and 2 i + 2, the leaves hold `LEAF` triangles each, and what pads the last level has empty boxes.
Point against triangle: C. Ericson, "Real-Time Collision Detection", 2005, section 5.1.5, rearranged
so that triangles without area need no division.
"""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.jit import kernel
from deltamesh_formats.array_types import Floats

LEAF = 4
# A path from the root leaves one sibling a level on the stack: 64 is more than any tree has.
_STACK = 64


@kernel
def squared_to_segment(p: Floats, a: Floats, b: Floats) -> float:
    """Return the squared distance from point p to the segment ab."""
    length, along = 0.0, 0.0
    for c in range(3):
        length += (b[c] - a[c]) * (b[c] - a[c])
        along += (p[c] - a[c]) * (b[c] - a[c])
    t = min(max(along / length, 0.0), 1.0) if length > 0.0 else 0.0
    total = 0.0
    for c in range(3):
        d = p[c] - a[c] - t * (b[c] - a[c])
        total += d * d
    return total


@kernel
def cross(o: Floats, a: Floats, b: Floats) -> tuple[float, float, float]:
    """Return (a - o) x (b - o)."""
    ax, ay, az = a[0] - o[0], a[1] - o[1], a[2] - o[2]
    bx, by, bz = b[0] - o[0], b[1] - o[1], b[2] - o[2]
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@kernel
def dot(a: tuple[float, float, float], b: tuple[float, float, float]) -> float:
    """Return the scalar product of two 3-vectors."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@kernel
def squared_to_triangle(p: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """Return the squared distance from point p to the triangle abc.

    To its plane where p projects into the triangle, else to the nearest edge.
    """
    n = cross(a, b, c)
    area = dot(n, n)
    if area > 0.0:
        inside = dot(n, cross(a, b, p)) >= 0.0
        inside = inside and dot(n, cross(b, c, p)) >= 0.0
        inside = inside and dot(n, cross(c, a, p)) >= 0.0
        if inside:
            height = dot(n, (p[0] - a[0], p[1] - a[1], p[2] - a[2]))
            return height * height / area
    return min(
        squared_to_segment(p, a, b), squared_to_segment(p, b, c), squared_to_segment(p, c, a)
    )


@kernel
def squared_to_box(p: Floats, low: Floats, high: Floats) -> float:
    """Return the squared distance from point p to the box; infinite when the box is empty."""
    total = 0.0
    for c in range(3):
        d = max(low[c] - p[c], p[c] - high[c], 0.0)
        total += d * d
    return total


@kernel
def fill_boxes(triangles: Floats, low: Floats, high: Floats) -> None:
    """Fill the boxes (nodes, 3) of the tree over triangles (m, 3, 3) in the order of the leaves."""
    nodes = len(low)
    leaves = (nodes + 1) // 2
    low[:] = np.inf
    high[:] = -np.inf
    for t in range(len(triangles)):
        node = leaves - 1 + t // LEAF
        for corner in range(3):
            low[node] = np.minimum(low[node], triangles[t, corner])
            high[node] = np.maximum(high[node], triangles[t, corner])
    for node in range(leaves - 2, -1, -1):
        low[node] = np.minimum(low[2 * node + 1], low[2 * node + 2])
        high[node] = np.maximum(high[2 * node + 1], high[2 * node + 2])


@kernel
def squared_to_mesh(
    p: Floats, triangles: Floats, low: Floats, high: Floats, bound: float, enough: float
) -> float:
    """Return the squared distance from p to the nearest triangle.

    `bound` is a known upper bound. The search stops as soon as the distance is known to be at most
    `enough`, and returns an upper bound not above it.
    """
    leaves = (len(low) + 1) // 2
    stack = np.empty(_STACK, np.int64)
    stack[0] = 0
    top = 1
    while top > 0 and bound > enough:
        top -= 1
        node = stack[top]
        if squared_to_box(p, low[node], high[node]) >= bound:
            continue
        if node < leaves - 1:
            left, right = 2 * node + 1, 2 * node + 2
            near = squared_to_box(p, low[left], high[left])
            if near <= squared_to_box(p, low[right], high[right]):
                left, right = right, left
            stack[top] = left
            stack[top + 1] = right
            top += 2
            continue
        first = (node - leaves + 1) * LEAF
        for t in range(first, min(first + LEAF, len(triangles))):
            bound = min(
                bound, squared_to_triangle(p, triangles[t, 0], triangles[t, 1], triangles[t, 2])
            )
    return bound


@kernel
def largest_squared_distance(
    points: Floats,
    bounds: Floats,
    triangles: Floats,
    low: Floats,
    high: Floats,
    largest: float,
) -> float:
    """Return the largest squared distance from the points to the mesh; at least `largest`.

    A point whose distance cannot be the largest is left as soon as that is known; bounds (s,) are
    upper bounds of the points' squared distances. A. A. Taha, A. Hanbury, "An efficient algorithm
    for calculating the exact Hausdorff distance", IEEE TPAMI 37(11), 2015 ("early breaking").
    """
    for i in range(len(points)):
        if bounds[i] > largest:
            d = squared_to_mesh(points[i], triangles, low, high, bounds[i], largest)
            largest = max(largest, d)
    return largest
