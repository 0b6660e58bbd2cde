"""Order of the vertices of a mesh, in steps; `src/core/vertex_order.c`."""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.core import OK, call, graph, ints, ints_out, scratch
from deltamesh_formats.array_types import Ints, Shorts


def code_vertices(
    c: Coder,
    indptr: Shorts,
    indices: Shorts,
    mirror: Ints,
    newest: int,
    order: Ints,
    margin: int,
    stop: int,
) -> bool:
    """Code the vertex of each rank, `order` (n,), filled in place when decoding.

    The neighbours are as `adjacency.adjacency` returns them; entry e, of row v, is the edge from v
    to `indices[e]`, and `mirror[e]` the entry of the edge back. The anchor of a vertex is the
    newest or the oldest of its neighbours that have a rank. At most `stop` ranks are coded. Return
    False for a stream that no encoder has written.
    """
    n, entries = len(order), len(indices)
    status = call(
        "dm_code_vertices",
        c.pointer,
        *graph(indptr, indices, n),
        ints(mirror, entries),
        newest,
        ints_out(order, n),
        margin,
        stop,
        *(scratch(size) for size in (n + 1, n + 1, entries, entries, n, 3 * n)),
    )
    return status == OK
