"""Inverses of permutations."""

from __future__ import annotations

import numpy as np

from deltamesh_formats.array_types import Ints


def rank_of(order: Ints) -> Ints:
    """Return the place of each element in an order, int64 (n,): the inverse of a permutation."""
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank
