"""Parallelograms that predict vertices; `src/core/parallelograms.c`."""

from __future__ import annotations

import numpy as np

from deltamesh._kernels.core import address, call, ints, shorts, shorts_out
from deltamesh_formats.array_types import Ints, Shorts


def find(faces: Ints, n: int, opposite: Ints, quads: Ints) -> tuple[Shorts, Shorts, Shorts]:
    """Return `first`, `corners` and `within`; see `parallelograms.parallelograms`.

    faces : int64 (m, 3), opposite : int64 (3 m,), quads : int64 (q, 4), over n vertices.
    """
    m, q = len(faces), len(quads)
    mesh = ints(faces, m, 3), m, n, ints(opposite, 3 * m), ints(quads, q, 4), q
    first, within = np.empty(n + 1, dtype=np.int32), np.empty(n, dtype=np.int32)
    call("dm_count_parallelograms", *mesh, shorts_out(first, n + 1), shorts_out(within, n))
    count = int(first[-1])
    corners, place = np.empty((count, 3), dtype=np.int32), np.empty(n, dtype=np.int32)
    listed = shorts(first, n + 1), count, shorts_out(corners, count, 3), address(place)
    call("dm_list_parallelograms", *mesh, *listed)
    return first, corners, within
