"""Walk over two meshes at once; `src/core/correspondence.c`."""

from __future__ import annotations

from ctypes import byref

from deltamesh._kernels.core import OK, call, ints, ints_out, number
from deltamesh_formats.array_types import Ints


def assign(source: int, target: int, mapping: Ints, inverse: Ints, log: Ints, count: int) -> int:
    """Map source to target, one to one, and log a new pair; return the new count or -1."""
    n, m, found = len(mapping), len(inverse), number()
    found.value = count
    arrays = ints_out(mapping, n), n, ints_out(inverse, m), m, ints_out(log, n)
    status = call("dm_assign", source, target, *arrays, byref(found))
    return found.value if status == OK else -1


def propagate(
    corners: Ints,
    opposite: Ints,
    colours: Ints,
    other_corners: Ints,
    other_opposite: Ints,
    other_colours: Ints,
    half_edge: int,
    other_half_edge: int,
    vertices: Ints,
    inverse_vertices: Ints,
    half_edges: Ints,
    inverse_half_edges: Ints,
    vertex_log: Ints,
    face_log: Ints,
) -> bool:
    """Map the patch around a half-edge of one mesh onto that around a half-edge of another.

    Half-edge h runs from `corners[h]` to the next corner of face `h // 3`; `opposite[h]` is the one
    half-edge that runs back along it, or -1 at a boundary, at an edge of three faces, or between
    faces of different winding. A patch is the faces that can be reached over opposites.

    corners, other_corners : int64 (3 m,), the flat faces.
    colours, other_colours : int64 (n,); vertices of different colour cannot correspond.
    vertices, half_edges : the maps so far, -1 where there is none, with their inverses; changed in
    place, and back again when the patches differ (False). A face's half-edges are mapped together,
    only that of its first corner is kept: entry `3 f` at `half_edges[f]`.
    """
    m, n, others, k = len(half_edges), len(colours), len(inverse_half_edges), len(other_colours)
    status = call(
        "dm_propagate",
        ints(corners, 3 * m),
        ints(opposite, 3 * m),
        m,
        ints(colours, n),
        n,
        ints(other_corners, 3 * others),
        ints(other_opposite, 3 * others),
        others,
        ints(other_colours, k),
        k,
        half_edge,
        other_half_edge,
        ints_out(vertices, n),
        ints_out(inverse_vertices, k),
        ints_out(half_edges, m),
        ints_out(inverse_half_edges, others),
        ints_out(vertex_log, n),
        ints_out(face_log, m),
    )
    return status == OK
