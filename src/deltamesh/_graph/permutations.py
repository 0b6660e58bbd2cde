"""Permutations, and the numbering of values by first appearance."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_Ints = NDArray[np.int64]


def inverse(permutation: _Ints) -> _Ints:
    """Return the inverse of a permutation (n,)."""
    result = np.empty_like(permutation)
    result[permutation] = np.arange(len(permutation))
    return result
