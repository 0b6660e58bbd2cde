"""Diagonals of quads, chosen walking over the surface."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.jit import kernel
from deltamesh_formats.array_types import Ints


@kernel
def choose(start: Ints, near: Ints, unlike: Ints, cut: Ints) -> None:
    """Choose one of two diagonals for each quad, breadth first, by a vote of its neighbours.

    start : int64 (q + 1,), near : int64 (e,), the neighbours of each quad.
    unlike : int64 (e,), 1 if the diagonals of both should differ, else 0.
    cut : int64 (q,), 0 or 1 where it is given, else -1: filled in.
    """
    votes = np.zeros((len(cut), 2), np.int64)
    queued = np.zeros(len(cut), np.bool_)
    queue = np.empty(len(cut), np.int64)
    head, tail = 0, 0
    for seed in range(len(cut)):
        if not queued[seed]:
            queued[seed] = True
            queue[tail] = seed
            tail += 1
        while head < tail:
            q = queue[head]
            head += 1
            if cut[q] < 0:
                cut[q] = 1 if votes[q, 1] > votes[q, 0] else 0
            for at in range(start[q], start[q + 1]):
                r = near[at]
                votes[r, cut[q] ^ unlike[at]] += 1
                if not queued[r]:
                    queued[r] = True
                    queue[tail] = r
                    tail += 1
