"""Hidden edges between triangles: the triangles on both sides are merged into one polygon.

See `src/core/hidden_edges.c`; further pairs are explicit (`merged_pairs`).
"""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import call, ints, ints_out, scratch
from deltamesh_formats.array_types import Ints

MODEL = model_of("hidden_edges")
SLOTS, MIXERS = MODEL


def code_hidden(
    c: Coder,
    corners: Ints,
    count: int,
    candidate: Ints,
    merged: Ints,
    parent: Ints,
    size: Ints,
    least: int,
    most: int,
    more: bool,
) -> None:
    """Code which half-edges are merged with their candidates.

    corners : int64 (3 m,), the vertices of triangles, in [0, count).
    candidate : int64 (3 m,), the half-edge that each may be merged with, -1 for none.
    merged : int64 (3 m,), the half-edge that each is merged with, -1 for none; when decoding, -1,
        and filled in. Others than the candidates are ignored.
    parent, size : int64 (m,), the forest of polygons so far, and the corners of each root's.
    least, most : bounds of the corners of a polygon.
    more : whether explicit pairs of half-edges follow.
    """
    h, m = len(corners), len(parent)
    call(
        "dm_code_hidden",
        c.pointer,
        ints(corners, 3 * m),
        m,
        count,
        ints(candidate, h),
        ints_out(merged, h),
        ints_out(parent, m),
        ints_out(size, m),
        least,
        most,
        more,
        scratch(h),
        scratch(m),
        scratch(3, count),
    )
