"""Order of the polygons of a mesh, and their rotations, in steps; `src/core/face_order.c`."""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.core import OK, call, ints, ints_out, scratch
from deltamesh_formats.array_types import Ints


def code_faces(
    c: Coder,
    faces: Ints,
    corners: Ints,
    offsets: Ints,
    within: Ints,
    rank: Ints,
    ranked: int,
    mode: int,
    order: Ints,
    rotations: Ints,
    margin: int,
    stop: int,
) -> bool:
    """Code which polygon comes when, `order` (m,), and at which corner it begins, `rotations` (m,).

    Both are filled in place when decoding. The vertices of a polygon are `corners[offsets[i]:
    offsets[i + 1]]`; a triangle represents it, `faces` (m, 3), at whose corners are those by
    `within` (m, 3). `rank` (n,) has the ranks of the vertices, -1 without one; `ranked` have one,
    and the others get the next ones as polygons come to use them. The anchor of a polygon is its
    FIRST vertex, or the OLDEST or NEWEST of those with a rank. At most `stop` polygons are coded.
    Return False for a stream that no encoder has written.
    """
    m, n, count = len(faces), len(rank), len(corners)
    status = call(
        "dm_code_faces",
        c.pointer,
        ints(faces, m, 3),
        m,
        ints(corners, count),
        count,
        ints(offsets, m + 1),
        ints(within, m, 3),
        ints_out(rank, n),
        n,
        ranked,
        mode,
        ints_out(order, m),
        ints_out(rotations, m),
        margin,
        stop,
        *(scratch(size) for size in (n, m + 1, m + 1, 3 * m, 3 * m, n)),
    )
    return status == OK
