"""Inverses of permutations, ranges of indices, and numbers of values by first appearance."""

from __future__ import annotations

import numpy as np

from deltamesh_formats.array_types import Ints


def inverse(order: Ints) -> Ints:
    """Return the rank of each element in an order (n,): the inverse of a permutation."""
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    return rank


def ranges(first: Ints, count: Ints) -> Ints:
    """Return so many integers from each first one on, one range after the other."""
    end = np.cumsum(count)
    return np.arange(int(count.sum())) + np.repeat(first - end + count, count)


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
    distinct, first, label = np.unique(values, return_index=True, return_inverse=True)
    by_appearance = np.argsort(first)
    return inverse(by_appearance)[label.ravel()], distinct[by_appearance]
