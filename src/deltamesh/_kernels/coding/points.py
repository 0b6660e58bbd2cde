"""Positions of anchors and isolated vertices, which are stored beside the deltas.

See `src/core/points.c`.
"""

from __future__ import annotations

from deltamesh._kernels.coding.coder import Coder
from deltamesh._kernels.coding.models import model_of
from deltamesh._kernels.core import OK, call, ints, ints_out
from deltamesh_formats.array_types import Ints

MODEL = model_of("points")
SLOTS, MIXERS = MODEL


def code_gaps(c: Coder, indices: Ints, n: int) -> bool:
    """Code ascending indices below n, filled in when decoding; return whether they fit."""
    count = len(indices)
    return call("dm_code_gaps", c.pointer, ints_out(indices, count), count, n) == OK


def code_points(c: Coder, points: Ints, bits: Ints, extra: Ints) -> None:
    """Code `points` (k, 3), filled in when decoding, in `bits` (3,) and `extra` (k,) bits each."""
    count = len(points)
    arrays = ints_out(points, count, 3), count, ints(bits, 3), ints(extra, count)
    call("dm_code_points", c.pointer, *arrays)


def code_sorted_points(c: Coder, points: Ints, bits: Ints) -> bool:
    """Code `points` (k, 3) in ascending order of x, as steps in x; return whether x fits."""
    count = len(points)
    arrays = ints_out(points, count, 3), count, ints(bits, 3)
    return call("dm_code_sorted_points", c.pointer, *arrays) == OK
