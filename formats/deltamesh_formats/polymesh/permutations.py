"""Inverses of permutations, ranges of indices, distinct values and their numbers."""

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


def distinct(values: Ints) -> Ints:
    """Return the different ones of values (count,), ascending.

    `np.unique` without further results imports masked arrays, which takes 10 ms.
    """
    ordered: Ints = np.sort(values)
    is_first = np.ones(len(ordered), dtype=bool)
    is_first[1:] = ordered[1:] != ordered[:-1]
    return ordered[is_first]


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
    found, first, label = np.unique(values, return_index=True, return_inverse=True)
    by_appearance = np.argsort(first)
    return inverse(by_appearance)[label.ravel()], found[by_appearance]
