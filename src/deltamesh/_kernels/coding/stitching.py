"""Stitches of a manifold: vertices at one point, and faces reversed, repeated or degenerate.

See `src/core/stitching.c`.
"""

from __future__ import annotations

from ctypes import byref

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import (
    OK,
    bools,
    bools_out,
    call,
    graph,
    ints,
    ints_out,
    number,
    scratch,
)
from deltamesh_formats.array_types import Bools, Ints, Shorts

MODEL = model_of("stitching")
SLOTS, MIXERS = MODEL


def code_stitches(c: Coder, indptr: Shorts, indices: Shorts, boundary: Bools, points: Ints) -> int:
    """Code `points` (n,), filled in when decoding; return how many there are, -1: corrupt.

    Points are numbered in the order of their first vertices. `boundary` (n,) is whether vertices
    are on a boundary of the manifold; their neighbours are those of `adjacency.adjacency`.
    """
    n, count = len(points), number()
    status = call(
        "dm_code_stitches",
        c.pointer,
        *graph(indptr, indices, n),
        bools(boundary, n),
        ints_out(points, n),
        *(scratch(n) for _ in range(3)),
        byref(count),
    )
    return count.value if status == OK else -1


def code_reversed(c: Coder, opposite: Ints, reversed_: Bools) -> None:
    """Code which faces (m,) are reversed, filled in when decoding."""
    m = len(reversed_)
    call("dm_code_reversed", c.pointer, ints(opposite, 3 * m), m, bools_out(reversed_, m))


def code_repeats(c: Coder, opposite: Ints, repeats: Ints, total: int) -> bool:
    """Code how often each face is repeated, `repeats` (m, 2): in its winding, in the opposite one.

    Filled in when decoding; return whether the sum is the total.
    """
    m = len(repeats)
    arrays = ints(opposite, 3 * m), m, ints_out(repeats, m, 2)
    return call("dm_code_repeats", c.pointer, *arrays, total) == OK


def code_degenerate(c: Coder, indptr: Shorts, indices: Shorts, pairs: Ints, n: int) -> bool:
    """Code faces (a, a, b) as `pairs` (d, 2) of a and b, in ascending order of a.

    Filled in when decoding; return whether they ascend below n, the number of points, of which
    those of the graph come first.
    """
    used, count = len(indptr) - 1, len(pairs)
    arrays = *graph(indptr, indices, used), ints_out(pairs, count, 2), count
    return call("dm_code_degenerate", c.pointer, *arrays, n) == OK
