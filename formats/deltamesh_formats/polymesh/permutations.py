"""Inverses of permutations."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def rank_of(order: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the place of each element in an order, int64 (n,): the inverse of a permutation."""
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank
