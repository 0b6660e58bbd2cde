"""Merged half-edges that are no candidates of each other, coded as explicit pairs.

See `src/core/merged_pairs.c`.
"""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.core import OK, call, ints, ints_out, scratch
from deltamesh_formats.array_types import Ints


def code_explicit_pairs(
    c: Coder,
    candidate: Ints,
    pairs: Ints,
    merged: Ints,
    parent: Ints,
    size: Ints,
    most: int,
    total: int,
    order: Ints,
    group: Ints,
    across: Ints,
    bounds: Ints,
) -> bool:
    """Code the explicit pairs; return whether their number is the total.

    pairs : int64 (3 m,), the half-edge that each is to be merged with, -1 for none; empty when
        decoding.
    candidate, merged, parent, size : see `hidden_edges.code_hidden`; the last three are updated.
    order : int64 (3 m,), half-edges by start, end and index: group i has those from bounds[i] on.
    group : int64 (3 m,), of each half-edge.
    across : of each group, the group of the half-edges that run back, -1 for none.
    """
    h, m, groups = len(candidate), len(parent), len(across)
    status = call(
        "dm_code_explicit_pairs",
        c.pointer,
        ints(candidate, 3 * m),
        m,
        ints(pairs, 0 if c.registers.decoding else h),
        ints_out(merged, h),
        ints_out(parent, m),
        ints_out(size, m),
        most,
        total,
        ints(order, h),
        ints(group, h),
        ints(across, groups),
        ints(bounds, groups + 1),
        groups,
        scratch(groups),
        scratch(h),
        scratch(h),
    )
    return status == OK
