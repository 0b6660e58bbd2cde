"""Distance from points to a triangle mesh, by a tree of bounding boxes.

The tree is a complete binary one over the triangles in spatial order: node i has children 2 i + 1
and 2 i + 2, the leaves hold `LEAF` triangles each, and what pads the last level has empty boxes.
See `src/core/closest.c`.
"""

from __future__ import annotations

from ctypes import byref, c_double

from deltamesh._kernels.core import LIBRARY, call, constant, floats, floats_out
from deltamesh_formats.array_types import Floats

LEAF = constant("DM_LEAF")

LIBRARY.dm_squared_to_triangle.restype = c_double


def squared_to_triangle(p: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """Return the squared distance from point p to the triangle abc."""
    found: float = LIBRARY.dm_squared_to_triangle(*(floats(x, 3) for x in (p, a, b, c)))
    return found


def fill_boxes(triangles: Floats, low: Floats, high: Floats) -> None:
    """Fill the boxes (nodes, 3) of the tree over triangles (m, 3, 3) in the order of the leaves."""
    m, nodes = len(triangles), len(low)
    boxes = floats_out(low, nodes, 3), floats_out(high, nodes, 3)
    call("dm_fill_boxes", floats(triangles, m, 3, 3), m, *boxes, nodes)


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
    upper bounds of the points' squared distances.
    """
    s, m, nodes, found = len(points), len(triangles), len(low), c_double(largest)
    call(
        "dm_largest_squared_distance",
        floats(points, s, 3),
        floats(bounds, s),
        s,
        floats(triangles, m, 3, 3),
        m,
        floats(low, nodes, 3),
        floats(high, nodes, 3),
        nodes,
        byref(found),
    )
    return found.value
