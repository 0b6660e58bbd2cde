"""Permutations, and the numbering of values by first appearance."""

from __future__ import annotations

import numpy as np

from deltamesh_formats.array_types import Ints


def inverse(permutation: Ints) -> Ints:
    """Return the inverse of a permutation (n,)."""
    result = np.empty_like(permutation)
    result[permutation] = np.arange(len(permutation))
    return result


def numbered(values: Ints) -> tuple[Ints, Ints]:
    """Return values as numbers, in the order in which they first appear.

    Parameters
    ----------
    values : int64 (count,)

    Returns
    -------
    labels : int64 (count,)
        0 for the first value, 1 for the next one that differs, and so on.
    order : int64 (k,)
        The value of each label.
    """
    distinct, first, inverse = np.unique(values, return_index=True, return_inverse=True)
    by = np.argsort(first)
    rank = np.empty(len(by), dtype=np.int64)
    rank[by] = np.arange(len(by))
    return rank[inverse.ravel()], distinct[by]
