"""Wedges, classes of corners at a point: split vertices, or the two sides of a seam.

See `src/core/wedges.c`.
"""

from __future__ import annotations

from ctypes import byref

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import OK, call, constant, ints, ints_out, number, scratch
from deltamesh_formats.array_types import Ints

# The kind of a corner, by its relation to the one that it is expected to be like: across an edge,
# the first of a further fan, in a repeat of a face, in a degenerate face.
ACROSS, FAN = constant("DM_ACROSS"), constant("DM_FAN")
REPEAT, DEGENERATE = constant("DM_REPEAT"), constant("DM_DEGENERATE")

MODEL = model_of("wedges")
SLOTS, MIXERS = MODEL


def fill_rings(
    opposite: Ints,
    corners: Ints,
    by_point: Ints,
    ring: Ints,
    spoke: Ints,
    closing: Ints,
) -> None:
    """Put the corners of each point into rotational order, fan by fan.

    opposite : int64 (3 m,), of a manifold; corners : int64 (3 m,), its vertices.
    by_point : int64 (n,), the vertices in the order of their points.
    ring : int64 (3 m,), the corners; spoke : the half-edge that leads on to each from the corner
        before, -1 at the first of a fan; closing : that from the last of a closed fan to the first.
    """
    h, n = len(corners), len(by_point)
    mesh = ints(opposite, h), ints(corners, h), h // 3, ints(by_point, n), n
    out = ints_out(ring, h), ints_out(spoke, h), ints_out(closing, h)
    call("dm_fill_rings", *mesh, *out, scratch(n))


def code_wedges(
    c: Coder,
    opposite: Ints,
    bounds: Ints,
    ring: Ints,
    spoke: Ints,
    closing: Ints,
    like: Ints,
    kind: Ints,
    wedges: Ints,
    labels: int,
) -> int:
    """Code the wedges of corners; return how many there are, over all points.

    bounds : int64 (p + 1,), where the corners of each point begin in `ring`, `spoke`, `closing`,
        `like` (the corner that each is expected to be like, -1 for the first of a point), `kind`.
    wedges : int64, of each corner: any numbers below `labels` when encoding, which are compared at
        one point only. Replaced by numbers that ascend with the points and the visits.
    labels : 0 when decoding.
    """
    halfedges, points, n, total = len(opposite), len(bounds) - 1, len(ring), number()
    call(
        "dm_code_wedges",
        c.pointer,
        ints(opposite, halfedges),
        halfedges,
        ints(bounds, points + 1),
        points,
        *(ints(array, n) for array in (ring, spoke, closing, like, kind)),
        n,
        ints_out(wedges, n),
        labels,
        *(scratch(size) for size in (halfedges, labels, labels, n, n)),
        byref(total),
    )
    return total.value


def code_isolated(c: Coder, isolated: Ints, total: int) -> bool:
    """Code the number of isolated vertices at each point; return whether the sum is the total.

    isolated : int64 (p,), filled in when decoding.
    """
    points = len(isolated)
    return call("dm_code_isolated", c.pointer, ints_out(isolated, points), points, total) == OK
