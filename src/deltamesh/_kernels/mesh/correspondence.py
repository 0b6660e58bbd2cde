"""Walk over two meshes at once."""

from __future__ import annotations

from deltamesh._kernels.jit import kernel
from deltamesh_formats.array_types import Ints


@kernel
def assign(source: int, target: int, mapping: Ints, inverse: Ints, log: Ints, count: int) -> int:
    """Map source to target, one to one, and log a new pair; return the new count or -1."""
    if mapping[source] == target:
        return count
    if mapping[source] >= 0 or inverse[target] >= 0:
        return -1
    mapping[source] = target
    inverse[target] = source
    log[count] = source
    return count + 1


@kernel
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
    vertex_count, face_count, head = 0, 0, 0
    # Opposites find the face of a half-edge that should be mapped; this pair starts the first face.
    h, g = half_edge, other_half_edge
    while True:
        f, at = h // 3, h % 3
        e = g // 3
        start = 3 * e + (g % 3 + 3 - at) % 3  # what corresponds to half-edge 3 f
        ok = True
        if half_edges[f] != start:
            ok = half_edges[f] < 0 and inverse_half_edges[e] < 0
            if ok:
                half_edges[f] = start
                inverse_half_edges[e] = f
                face_log[face_count] = f
                face_count += 1
            for i in range(3):
                if ok:
                    a, b = corners[3 * f + i], other_corners[3 * e + (start + i) % 3]
                    ok = colours[a] == other_colours[b]
                    if ok:
                        new = assign(a, b, vertices, inverse_vertices, vertex_log, vertex_count)
                        ok = new >= 0
                        vertex_count = max(new, vertex_count)
        # On to the next half-edge of the logged faces that has an opposite.
        h = -1
        while ok and h < 0 and head < 3 * face_count:
            f, at = face_log[head // 3], head % 3
            start = half_edges[f]
            h = opposite[3 * f + at]
            g = other_opposite[start // 3 * 3 + (start + at) % 3]
            ok = (h < 0) == (g < 0)
            head += 1
        if not ok:
            for i in range(vertex_count):
                inverse_vertices[vertices[vertex_log[i]]] = -1
                vertices[vertex_log[i]] = -1
            for i in range(face_count):
                inverse_half_edges[half_edges[face_log[i]] // 3] = -1
                half_edges[face_log[i]] = -1
            return False
        if h < 0:
            return True
