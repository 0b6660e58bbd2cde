"""Diagonals of quads, chosen walking over the surface; `src/core/diagonals.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import bools_out, call, ints, ints_out, scratch
from deltamesh_formats.array_types import Ints


def choose(start: Ints, near: Ints, unlike: Ints, cut: Ints) -> None:
    """Choose one of two diagonals for each quad, breadth first, by a vote of its neighbours.

    start : int64 (q + 1,), near : int64 (e,), the neighbours of each quad.
    unlike : int64 (e,), 1 if the diagonals of both should differ, else 0.
    cut : int64 (q,), 0 or 1 where it is given, else -1: filled in.
    """
    quads, entries = len(cut), len(near)
    queued = np.empty(quads, dtype=bool)
    rows = ints(start, quads + 1), quads, ints(near, entries), ints(unlike, entries), entries
    memory = scratch(quads, 2), bools_out(queued, quads), scratch(quads)
    call("dm_choose_diagonals", *rows, ints_out(cut, quads), *memory)
